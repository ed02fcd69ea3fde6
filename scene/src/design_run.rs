//! A design run: the search of a scene, with its state and its inputs stored in the run folder.
//!
//! The state is saved about once per second and at the end; the next run of the scene continues
//! from it.

use crate::{
    checked_scene::{MODEL_PARTS, Scene},
    coarse_search::CoarseSearch,
    keys::SceneConfig,
    level::Level,
    run_inputs::{self, InputHashes, STATE_FILE, unused},
};
use design::{
    objective::{
        design_problem::{DesignProblem, Evaluation},
        terms::panel_width::thinnest_panel,
    },
    optimise::outer_loop::{Ended, SearchState, StepRecord, Until, optimise},
    pattern::design_vector::DesignVector,
};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::{
    collections::BTreeSet,
    path::Path,
    sync::{Arc, atomic::AtomicBool},
    time::{Duration, Instant},
};
use support::{Fault, Joined, at, ensure, regular_file, sealed_json, whole_file};

/// The folder of the coarse searches, in the folder of a run.
pub const LEVELS: &str = "levels";

const SAVE_EVERY: Duration = Duration::from_secs(1);

/// What an error of the start is about.
pub const START: &str = "the start of the search cannot be evaluated";
const BEST: &str = "the best design of the run cannot be evaluated again";

/// A finished run.
pub struct Designed {
    /// Its scene.
    pub scene: Scene,
    /// The design problem of the scene.
    pub problem: DesignProblem,
    /// Why the search ended.
    pub ended: Ended,
    /// The state of the search, with one record per step.
    pub search: SearchState,
    /// The evaluation of the start.
    pub start: Evaluation,
    /// The evaluation of the best design, whose path is followed from the flat sheet.
    pub best: Evaluation,
    /// The searches at coarser levels, with whose best design the search began; empty if it began at
    /// the start of the scene.
    pub coarse_searches: Vec<CoarseSearch>,
}

/// The scene of a run and the state of its search.
#[derive(Debug, Serialize, Deserialize)]
struct RunState {
    scene: SceneConfig,
    /// [`Scene::model_hash`].
    model: String,
    /// The copies in the run folder of what the run depends on.
    inputs: InputHashes,
    /// How the search ended; `None` while it is under way.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    ended: Option<Ended>,
    /// See [`Designed::coarse_searches`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    coarse_searches: Vec<CoarseSearch>,
    #[serde(flatten)]
    search: SearchState,
}

/// The design in a JSON file: the best design of a run's state, or a design alone.
pub fn stored_design(path: &Path, scene: &Scene) -> Result<DesignVector, Fault> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Stored {
        Run { best: DesignVector },
        Alone(DesignVector),
    }
    let text = regular_file::read(path).map_err(unused(path))?;
    let stored = sealed_json::from_slice_by_hand(&text);
    let stored = stored.map_err(|error| no_state(path, &error))?;
    let (Stored::Run { best: design } | Stored::Alone(design)) = stored;
    same_size(path, design.same_shape(&scene.start()))?;
    Ok(design)
}

fn no_state(path: &Path, error: &Fault) -> Fault {
    format!(
        "{} is neither the state of a run nor a design ({error}): give another file, or restart the \
         run",
        path.display()
    )
    .into()
}

fn same_size(path: &Path, fits: bool) -> Result<(), Fault> {
    ensure!(
        fits,
        "{} contains a design of another size than the scene's: give another file, or restart the run",
        path.display()
    );
    Ok(())
}

/// The best design of the run in the scene's run folder; `None` if there is no run.
///
/// It is an error if the run is of another scene or model.
pub fn design_of_run(scene: &Scene) -> Result<Option<DesignVector>, Fault> {
    let remedy = "design it again (`kirigami design --restart`), or name the file with --design to take its design nevertheless";
    let state = RunState::unchanged(scene, &SEARCH_KEYS, "is not the run of this scene", remedy)?;
    Ok(state.map(|state| state.search.best))
}

/// How the run in the scene's run folder was left, and its search; `None` if there is no run.
///
/// It is an error if the run is of another scene or model.
pub fn left_run(scene: &Scene) -> Result<Option<(Ended, SearchState)>, Fault> {
    let state = RunState::read(scene)?;
    Ok(state.map(|state| (state.left(), state.search)))
}

/// The keys of a scene by which a design is found. They change neither its sheet nor how it
/// deploys.
const SEARCH_KEYS: [&str; 3] = ["objective", "optimiser", "tolerances"];

/// The searches at coarser levels before a search.
#[derive(Default)]
pub struct Earlier {
    /// What is kept of them, the coarsest first.
    pub searches: Vec<CoarseSearch>,
    /// The last one, from whose best design and with whose optimiser the next one goes on.
    pub last: Option<SearchState>,
}

/// Called with the level and the state of a search after each of its steps.
pub type OnStep<'a> = &'a mut dyn FnMut(Level, &SearchState);

/// A run whose start is evaluated.
pub struct BegunRun {
    /// The scene of the run.
    pub scene: Scene,
    /// Its design problem.
    pub problem: DesignProblem,
    /// The evaluation of its start.
    pub start: Evaluation,
}

impl Designed {
    /// The records of all its searches. The start of each but the first is the end of the search
    /// before, at another level.
    pub fn history(&self) -> Vec<StepRecord> {
        let coarse = self.coarse_searches.iter().map(|search| &search.history);
        let mut all: Vec<StepRecord> = Vec::new();
        for record in coarse.chain([&self.search.history]).flatten() {
            all.push(StepRecord { step: all.len(), ..record.clone() });
        }
        all
    }

    /// The start of a scene before any step of its search, with its path followed from the flat
    /// sheet until `stop` becomes true.
    pub fn at_start(scene: &Scene, stop: Arc<AtomicBool>) -> Result<Self, Fault> {
        let run = BegunRun::new(scene.clone(), Some(stop))?;
        let search = run.begun();
        run.designed(Ended::Stopped, search, Vec::new())
    }

    /// The run in the run folder of a scene as it was left, with its paths followed from the flat
    /// sheet until `stop` becomes true; `None` if there is no run.
    pub fn of_run(scene: &Scene, stop: Arc<AtomicBool>) -> Result<Option<Self>, Fault> {
        let Some(state) = RunState::read(scene)? else {
            return Ok(None);
        };
        let run = BegunRun::new(scene.clone(), Some(stop))?;
        let ended = state.left();
        let RunState { coarse_searches, mut search, .. } = state;
        search.pause(&run.problem);
        run.designed(ended, search, coarse_searches).map(Some)
    }
}

impl BegunRun {
    /// Evaluates the start of a scene; its paths are followed until `stop` becomes true.
    pub fn new(scene: Scene, stop: Option<Arc<AtomicBool>>) -> Result<Self, Fault> {
        let mut problem = scene.problem()?;
        if let Some(stop) = stop {
            problem.stop_by(stop);
        }
        let start = problem.evaluate(&scene.start()).map_err(at(START))?;
        Ok(Self { scene, problem, start })
    }

    /// The search at its start.
    pub fn begun(&self) -> SearchState {
        let (optimiser, start) = (&self.scene.config.optimiser, self.scene.start());
        let (method, rate) = (optimiser.method, optimiser.learning_rate);
        SearchState::new(&self.problem, start, &self.start, method, rate)
    }

    /// Runs the search in the run folder of the scene, `until` then; continues from the state there
    /// if steps have been made. Without `until` it makes all steps of the scene; after searches at
    /// coarser levels as many of them as it takes to converge, unless the run was made with fewer.
    ///
    /// `progress` is called after every step; the run stops at the end
    /// of the step during which `stop` becomes true.
    pub fn search(
        self,
        earlier: &Earlier,
        until: Option<Until>,
        stop: &AtomicBool,
        progress: OnStep,
    ) -> Result<Designed, Fault> {
        let Self { scene, problem, start } = &self;
        let (level, steps) = (scene.config.level, scene.config.optimiser.steps);
        let folder = scene.output();
        std::fs::create_dir_all(&folder).map_err(unused(&folder))?;
        let path = folder.join(STATE_FILE);
        wide_enough(scene, start)?;
        let begun = RunState::read(scene)?
            .filter(|state| earlier.last.is_none() || state.search.last().step > 0);
        // More steps than before are all made.
        let more = begun.as_ref().is_some_and(|state| steps > state.scene.optimiser.steps);
        let complete =
            begun.as_ref().is_some_and(|state| !more && state.ended == Some(Ended::Completed));
        let (searches, mut search) = match (begun, &earlier.last) {
            (Some(state), _) => (state.coarse_searches, state.search),
            (None, last) => {
                let search = match last {
                    Some(coarser) => {
                        let evaluation = problem.evaluate(&coarser.best).map_err(at(START))?;
                        SearchState::after(coarser, problem, coarser.best.clone(), &evaluation)
                    }
                    None => self.begun(),
                };
                progress(level, &search);
                (earlier.searches.clone(), search)
            }
        };
        let converged = !searches.is_empty() && !more;
        let steps = if complete { search.last().step } else { steps };
        let until = until.unwrap_or(Until { steps, converged });
        let inputs = run_inputs::keep(scene)?;
        let save = |search: &SearchState, ended: Option<&Ended>| {
            let state = RunState {
                scene: scene.config.clone(),
                model: scene.model_hash(),
                inputs: inputs.clone(),
                ended: ended.cloned(),
                coarse_searches: searches.clone(),
                search: search.clone(),
            };
            state.write(&path)
        };
        // The state names the hashes of the inputs that have just been written.
        save(&search, None)?;
        let mut saved = Instant::now();
        let ended = optimise(problem, &mut search, until, stop, &mut |search| {
            progress(level, search);
            if saved.elapsed() > SAVE_EVERY {
                save(search, None)?;
                saved = Instant::now();
            }
            Ok::<_, Fault>(())
        })?;
        save(&search, Some(&ended))?;
        self.designed(ended, search, searches)
    }

    /// A search that has ended. The path of a start that is the best design is not followed again.
    fn designed(
        self,
        ended: Ended,
        search: SearchState,
        coarse_searches: Vec<CoarseSearch>,
    ) -> Result<Designed, Fault> {
        let Self { scene, problem, start } = self;
        let best = match search.best == scene.start() {
            true => start.clone(),
            false => problem.evaluate(&search.best).map_err(at(BEST))?,
        };
        Ok(Designed { scene, problem, ended, search, start, best, coarse_searches })
    }
}

/// An error if a panel of the start is so thin that the barrier of the minimum width is infinite.
fn wide_enough(scene: &Scene, start: &Evaluation) -> Result<(), Fault> {
    let minimum = scene.config.objective.min_panel_width;
    let panels = start.deployment.sheet.panels.iter();
    let panels: Vec<_> = panels.map(|panel| panel.corners).collect();
    let thinnest = thinnest_panel(&panels);
    ensure!(
        minimum <= 0.0 || thinnest > minimum,
        "the start of the search has a panel of {thinnest:.3} mm, not wider than objective.min_panel_width = {minimum} mm: \
         reduce that, sheet.panels or optimiser.start_noise"
    );
    Ok(())
}

impl RunState {
    /// How the search was left.
    fn left(&self) -> Ended {
        match &self.ended {
            Some(ended) => ended.clone(),
            // It was killed, or written before its end was.
            None if self.search.history.len() > self.scene.optimiser.steps => Ended::Completed,
            None => Ended::Stopped,
        }
    }

    /// The keys of the scene and the inputs besides that changed since the run, in words; those
    /// `allowed` may. Empty if there are none.
    fn changes(&self, scene: &Scene, allowed: &[&str]) -> String {
        let forbidden = |name: &&str| !allowed.contains(name);
        let keys = self.changed_keys(scene);
        let keys = keys.iter().map(String::as_str).filter(forbidden);
        let inputs = self.changed_inputs(scene).into_iter().filter(forbidden);
        (keys.map(|key| format!("the key `{key}`")))
            .chain(inputs.map(|input| format!("the {input}")))
            .joined(", ")
    }

    /// The keys of the scene that changed since the run, without those that may: the number of
    /// steps, the title, the cutting and the tolerances, which change no design, and paths, since
    /// [`Scene::model_hash`] identifies what they name.
    fn changed_keys(&self, scene: &Scene) -> BTreeSet<String> {
        let mut before = self.scene.without_paths();
        before.optimiser.steps = scene.config.optimiser.steps;
        before.title.clone_from(&scene.config.title);
        before.cutting = scene.config.cutting;
        before.tolerances = scene.config.tolerances;
        let keys = |config: &SceneConfig| match serde_json::to_value(config) {
            Ok(Value::Object(keys)) => keys,
            _ => unreachable!("a run writes the same keys to its state"),
        };
        let (before, now) = (keys(&before), keys(&scene.config.without_paths()));
        let both = before.keys().chain(now.keys());
        both.filter(|key| before.get(*key) != now.get(*key)).cloned().collect()
    }

    /// The inputs besides the keys of the scene that changed since the run.
    fn changed_inputs(&self, scene: &Scene) -> Vec<&'static str> {
        let now = scene.model_hash();
        let mut before = self.model.split('-');
        let parts = MODEL_PARTS.into_iter().zip(now.split('-'));
        parts.filter(|(_, now)| before.next() != Some(*now)).map(|(part, _)| part).collect()
    }

    /// The state of an earlier run of the same scene; only the number of steps may differ.
    fn read(scene: &Scene) -> Result<Option<Self>, Fault> {
        let remedy = "restart it (--restart), or choose another output folder";
        Self::unchanged(scene, &[], "belongs to another run", remedy)
    }

    /// The state in the run folder of a scene, from which only the number of steps and the keys
    /// `allowed` may differ; the error says what the state is otherwise, and a remedy.
    fn unchanged(
        scene: &Scene,
        allowed: &[&str],
        otherwise: &str,
        remedy: &str,
    ) -> Result<Option<Self>, Fault> {
        let path = scene.output().join(STATE_FILE);
        let text = match regular_file::read(&path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            text => text.map_err(unused(&path))?,
        };
        let state: Self =
            sealed_json::from_slice(&text).map_err(|error| no_state(&path, &error))?;
        let changed = state.changes(scene, allowed);
        ensure!(
            changed.is_empty(),
            "{} {otherwise}, {changed} changed since: {remedy}",
            path.display()
        );
        same_size(&path, state.search.fits(&scene.start()))?;
        Ok(Some(state))
    }

    fn write(&self, path: &Path) -> Result<(), Fault> {
        let text = sealed_json::to_vec(self).map_err(unused(path))?;
        whole_file::write(path, &text).map_err(unused(path))
    }
}
