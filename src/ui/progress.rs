//! Progress with the time left: a bar on a terminal, otherwise one line per minute, and with notes one line per step.

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use support::verbose;

/// Interval between progress lines when the output is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(60);

/// Time left that is not shown (s): the estimate of a task that was resumed and has not yet finished a unit.
const LONGEST: u64 = 365 * 24 * 3600;

static SILENT: AtomicBool = AtomicBool::new(false);

/// Shows no progress from now on.
pub fn silence() {
    SILENT.store(true, Ordering::Relaxed);
}

/// Prints which of several tasks begins.
pub fn announce(task: &str) {
    if !SILENT.load(Ordering::Relaxed) {
        eprintln!("{task}");
    }
}

/// Progress of a task of known length.
pub struct Progress {
    bar: ProgressBar,
    what: &'static str,
    last_line: Cell<Instant>,
}

impl Progress {
    /// A task of `total` units of `what`.
    pub fn new(total: usize, what: &'static str) -> Self {
        let style = ProgressStyle::with_template("{prefix:>14} [{bar:30}] {pos}/{len}  {msg}")
            .expect("the template is a constant");
        // A bar would overwrite the notes.
        let target = if verbose::is_shown() {
            ProgressDrawTarget::hidden()
        } else {
            ProgressDrawTarget::stderr()
        };
        // A message wider than the terminal is continued on the next line: a number that was cut would be another one.
        let bar = ProgressBar::with_draw_target(Some(total as u64), target)
            .with_style(style.progress_chars("=> "))
            .with_prefix(what);
        Self {
            bar,
            what,
            last_line: Cell::new(Instant::now()),
        }
    }

    /// Sets the length of a task that is known only after its start.
    pub fn set_total(&self, total: usize) {
        self.bar.set_length(total as u64);
    }

    /// Shows that `done` units are finished; `seconds_left` replaces the bar's own estimate.
    pub fn show(&self, done: usize, seconds_left: Option<f64>, message: &str) {
        if SILENT.load(Ordering::Relaxed) {
            return;
        }
        self.bar.set_position(done as u64);
        // A note for every percent of a bar without messages would hide the others.
        let noted = verbose::is_shown() && !message.is_empty();
        let left = seconds_left.map_or_else(|| self.bar.eta(), Duration::from_secs_f64);
        let message = match left.as_secs() {
            0 | LONGEST.. => message.to_owned(),
            _ => format!("{} left  {message}", HumanDuration(left)),
        };
        let due = self.bar.is_hidden() && self.last_line.get().elapsed() > LINE_EVERY;
        if due || noted {
            self.last_line.set(Instant::now());
            let total = self.bar.length().unwrap_or_default();
            eprintln!("{} {done}/{total}  {message}", self.what);
        }
        self.bar.set_message(message);
    }

    /// Clears the bar.
    pub fn finish(self) {
        self.bar.finish_and_clear();
    }
}

/// Runs a task and shows how far it has come: `reached` is asked in between, from 0 to `paths` solved paths.
pub fn watched<T>(paths: usize, reached: impl Fn() -> f64 + Sync, task: impl FnOnce() -> T) -> T {
    /// Number of parts of a path on the progress bar.
    const PARTS: usize = 1000;
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let show = || {
            let bar = Progress::new(PARTS * paths, "1000 lambda");
            while !done.load(Ordering::Relaxed) {
                bar.show((PARTS as f64 * reached()) as usize, None, "");
                std::thread::sleep(Duration::from_millis(100));
            }
            bar.finish();
        };
        // Without a further thread there is no progress, but a result.
        let _ = std::thread::Builder::new().spawn_scoped(scope, show);
        let result = task();
        done.store(true, Ordering::Relaxed);
        result
    })
}

/// A time in seconds as readable text.
pub fn duration(seconds: f64) -> String {
    HumanDuration(Duration::from_secs_f64(seconds)).to_string()
}
