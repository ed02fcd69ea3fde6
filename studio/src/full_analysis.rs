//! The full analysis on a thread of its own: the path followed from the flat sheet, and the
//! report. Drafts go on meanwhile.

use crate::event::{Event, Kind, locked};
use analysis::design_checks::DesignChecks;
use anyhow::{Context, Result};
use app::failure::message;
use design::equilibrium::warm_start::WarmStart;
use output::{
    cut_file::CutLines,
    report::Report,
    run_page::{page_data, sheet_data},
};
use scene::{Scene, design_run::Designed};
use serde_json::json;
use std::{
    sync::{
        Arc, Condvar, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::Instant,
};
use support::caught_panic;

/// Who hears the events.
pub(crate) type Listener = Arc<dyn Fn(Event) + Send + Sync>;

/// A page as full analyses and runs show it: with the run whose best design it is, if the sheet has
/// one, and how long it took (ms), unless it is the end of a search.
pub(crate) fn shown(
    scene: &Scene,
    designed: &Designed,
    report: &Report,
    is_run: bool,
    ms: Option<f64>,
) -> Event {
    let run = is_run.then(|| run_name(scene));
    let page = page_data(scene, designed, report);
    Event::new(Kind::Page, &json!({ "page": page, "run": run, "ms": ms }))
}

/// A sheet at rest.
pub(crate) struct Resting {
    pub scene: Scene,
    /// Whether it is the best design of the run of the scene, and not the start of the scene.
    pub is_run: bool,
}

impl Resting {
    fn designed(&self, stop: Arc<AtomicBool>) -> Result<Designed> {
        let scene = &self.scene;
        if !self.is_run {
            return Ok(Designed::at_start(scene, stop)?);
        }
        Designed::of_run(scene, stop)?.with_context(|| {
            let folder = scene.output();
            format!("the run in {} is gone: change the sheet, or design it again", folder.display())
        })
    }
}

/// The name of the run folder of a scene.
pub(crate) fn run_name(scene: &Scene) -> String {
    let folder = scene.output();
    let name = folder.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

/// The thread, and what it is to compute.
pub(crate) struct FullAnalysis {
    wanted: Mutex<Wanted>,
    news: Condvar,
    listener: Listener,
}

#[derive(Default)]
struct Wanted {
    sheet: Option<Resting>,
    /// Ends the computation that is under way, of which nothing is shown then.
    stop: Arc<AtomicBool>,
    /// The path of the last one that was shown.
    path: Option<WarmStart>,
}

impl FullAnalysis {
    /// Starts the thread, which ends with the program. A page in a browser has none: there
    /// [`Self::compute`] computes at once.
    pub(crate) fn start(listener: Listener) -> std::io::Result<Arc<Self>> {
        let analysis = Arc::new(Self { wanted: Mutex::default(), news: Condvar::new(), listener });
        if cfg!(target_family = "wasm") {
            return Ok(analysis);
        }
        let thread = std::thread::Builder::new().name("everyday".into());
        thread.spawn({
            let analysis = Arc::clone(&analysis);
            move || {
                loop {
                    analysis.work();
                }
            }
        })?;
        Ok(analysis)
    }

    /// Computes a sheet next, and nothing else.
    pub(crate) fn compute(&self, sheet: Resting) {
        self.stop();
        locked(&self.wanted).sheet = Some(sheet);
        self.news.notify_one();
        if cfg!(target_family = "wasm") {
            self.work();
        }
    }

    /// The path of the last computation that was shown, once.
    pub(crate) fn last_path(&self) -> Option<WarmStart> {
        locked(&self.wanted).path.take()
    }

    /// Shows nothing of what is under way. Returns the path of the last computation that was shown,
    /// once.
    pub(crate) fn stop(&self) -> Option<WarmStart> {
        let mut wanted = locked(&self.wanted);
        wanted.sheet = None;
        wanted.stop.store(true, Ordering::Relaxed);
        wanted.path.take()
    }

    /// Shows the path of a sheet while its report is written.
    fn show_path(&self, scene: &Scene, designed: &Designed, stop: &AtomicBool) {
        let sheet = sheet_data(scene, &designed.problem, &designed.best.deployment);
        let event = Event::new(Kind::Path, &sheet);
        // Under the lock: nothing is shown after a stop.
        let _wanted = locked(&self.wanted);
        if !stop.load(Ordering::Relaxed) {
            (self.listener)(event);
        }
    }

    /// Computes the next sheet, as soon as there is one.
    fn work(&self) {
        let nothing = |wanted: &mut Wanted| wanted.sheet.is_none();
        let mut wanted = (self.news.wait_while(locked(&self.wanted), nothing))
            .unwrap_or_else(PoisonError::into_inner);
        let Some(sheet) = wanted.sheet.take() else {
            return;
        };
        let stop = Arc::new(AtomicBool::new(false));
        wanted.stop = Arc::clone(&stop);
        drop(wanted);
        let begin = Instant::now();
        let computed = caught_panic::catch(|| {
            let designed = sheet.designed(Arc::clone(&stop))?;
            self.show_path(&sheet.scene, &designed, &stop);
            Ok::<_, anyhow::Error>(page_of(&sheet, &designed, begin))
        });
        // Under the lock: nothing is shown after a stop.
        let mut wanted = locked(&self.wanted);
        if stop.load(Ordering::Relaxed) {
            return;
        }
        let event = match computed {
            Ok(Ok((page, path))) => {
                wanted.path = Some(path);
                page
            }
            Ok(Err(error)) => refusal(&message(&error)),
            Err(panic) => refusal(&format!("the report failed: {panic}")),
        };
        (self.listener)(event);
        (self.listener)(Event::new(Kind::Working, &()));
    }
}

pub(crate) fn milliseconds(begin: Instant) -> f64 {
    1e3 * begin.elapsed().as_secs_f64()
}

/// What is said of a request that is refused.
pub(crate) fn refusal(why: &str) -> Event {
    Event::new(Kind::Says, &json!({ "refused": true, "message": why }))
}

/// The page of a sheet, and its path.
fn page_of(sheet: &Resting, designed: &Designed, begin: Instant) -> (Event, WarmStart) {
    let scene = &sheet.scene;
    let best = &designed.best.deployment;
    let cuts = CutLines::of(scene, best);
    let report = Report::new(scene, designed, &cuts, DesignChecks::default(), false);
    let event = shown(scene, designed, &report, sheet.is_run, Some(milliseconds(begin)));
    (event, best.warm_start())
}
