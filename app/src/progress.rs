//! Progress with the time left: a bar on a terminal, otherwise one line per minute, and with notes
//! one line per step.

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::{
    cell::{Cell, OnceCell},
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};
use support::verbose;

/// Interval between progress lines when the output is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(60);

/// Part of the units that were left at the start, from which their mean duration says how long the
/// others take.
const ENOUGH: f64 = 0.05;

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
    /// Whether all units take about as long, so that the time left can be estimated.
    is_even: bool,
    /// When this run began, and how many units were finished then.
    begun: OnceCell<(Instant, usize)>,
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
        // A message wider than the terminal is continued on the next line: a number that was cut
        // would be another one.
        let bar = ProgressBar::with_draw_target(Some(total as u64), target)
            .with_style(style.progress_chars("=> "))
            .with_prefix(what);
        Self {
            bar,
            what,
            last_line: Cell::new(Instant::now()),
            is_even: true,
            begun: OnceCell::new(),
        }
    }

    /// A task whose units take times that differ by orders of magnitude, such as the increments of
    /// an equilibrium path: no time left is shown.
    fn uneven(total: usize, what: &'static str) -> Self {
        Self { is_even: false, ..Self::new(total, what) }
    }

    /// Sets the length of a task that is known only after its start.
    pub fn set_total(&self, total: usize) {
        self.bar.set_length(total as u64);
    }

    /// Shows that `done` units are finished; `seconds_left` replaces the estimate by the units of
    /// this run.
    pub fn show(&self, done: usize, seconds_left: Option<f64>, message: &str) {
        if SILENT.load(Ordering::Relaxed) {
            return;
        }
        self.bar.set_position(done as u64);
        // A note for every percent of a bar without messages would hide the others.
        let noted = verbose::is_shown() && !message.is_empty();
        let left = seconds_left.or_else(|| self.seconds_left(done));
        let message = match left.filter(|left| *left >= 1.0) {
            None => message.to_owned(),
            Some(left) => format!("{} left  {message}", duration(left)),
        };
        let due = self.bar.is_hidden() && self.last_line.get().elapsed() > LINE_EVERY;
        if due || noted {
            self.last_line.set(Instant::now());
            let total = self.bar.length().unwrap_or_default();
            eprintln!("{} {done}/{total}  {message}", self.what);
        }
        self.bar.set_message(message);
    }

    /// The time left by the mean duration of the units of this run; `None` if it cannot be
    /// estimated.
    fn seconds_left(&self, done: usize) -> Option<f64> {
        let (since, before) = *self.begun.get_or_init(|| (Instant::now(), done));
        let total = self.bar.length().unwrap_or_default() as usize;
        let [finished, all] = [done, total].map(|units| units.saturating_sub(before) as f64);
        (self.is_even && finished > ENOUGH * all)
            .then(|| since.elapsed().as_secs_f64() * (all - finished) / finished)
    }

    /// Clears the bar.
    pub fn finish(self) {
        self.bar.finish_and_clear();
    }
}

/// Runs a task and shows how far it has come: `reached` is asked in between, from 0 to `paths`
/// solved paths.
pub fn watched<T>(paths: usize, reached: impl Fn() -> f64 + Sync, task: impl FnOnce() -> T) -> T {
    /// Number of parts of a path on the progress bar.
    const PARTS: usize = 1000;
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let show = || {
            let bar = Progress::uneven(PARTS * paths, "1000 lambda");
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_left_is_shown_only_if_it_can_be_estimated() {
        let resumed = Progress::new(1000, "steps");
        assert_eq!(resumed.seconds_left(400), None);
        std::thread::sleep(Duration::from_millis(20));
        // 1 of 600 units is no measure; after 300 the others are expected to take as long.
        assert_eq!(resumed.seconds_left(401), None);
        let left = resumed.seconds_left(700).unwrap();
        assert!((0.02..10.0).contains(&left), "{left}");
        assert_eq!(resumed.seconds_left(1000), Some(0.0));
        let path = Progress::uneven(1000, "lambda");
        assert_eq!(path.seconds_left(0), None);
        assert_eq!(path.seconds_left(500), None);
    }
}
