//! A design run: the search of a scene, with its state and its inputs stored in the run folder.
//!
//! The state is saved about once per second and at the end; the next run of the scene continues
//! from it.

use crate::checked_scene::{MODEL_PARTS, Scene};
use crate::coarse_search::CoarseSearch;
use crate::keys::SceneConfig;
use crate::level::Level;
use crate::run_inputs::{self, InputHashes, RunInputsError, STATE_FILE};
use crate::scene_error::SceneError;
use design::objective::design_problem::{DesignError, DesignProblem, Evaluation};
use design::objective::terms::panel_width::thinnest_panel;
use design::optimise::outer_loop::{Ended, SearchState, Until, optimise};
use design::pattern::design_vector::DesignVector;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use support::sealed_json::{self, SealError};
use support::{FileError, regular_file, whole_file};

/// The folder of the coarse searches, in the folder of a run.
pub const LEVELS: &str = "levels";

const SAVE_EVERY: Duration = Duration::from_secs(1);

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
    /// The searches at coarser levels that found the start; empty if the search began at the start
    /// of the scene.
    pub coarse_searches: Vec<CoarseSearch>,
}

/// Why a run failed.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum InverseDesignError {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Inputs(#[from] RunInputsError),
    #[error("the start of the search cannot be evaluated: {0}")]
    Start(DesignError),
    #[error(
        "the start of the search has a panel of {thinnest:.3} mm, not wider than objective.min_panel_width = {minimum} mm: \
         reduce that, sheet.panels or optimiser.start_noise"
    )]
    ThinStart { thinnest: f64, minimum: f64 },
    #[error("the best design of the run cannot be evaluated again: {0}")]
    Best(DesignError),
    #[error("cannot use {0}")]
    Folder(#[from] FileError),
    #[error(
        "{path} is neither the state of a run nor a design ({source}): give another file, or restart the \
         run",
        path = .path.display()
    )]
    State { path: PathBuf, source: SealError },
    #[error(
        "{path} contains a design of another size than the scene's: give another file, or restart the run",
        path = .path.display()
    )]
    OtherSize { path: PathBuf },
    #[error(
        "{path} belongs to another run, {changed} changed since: restart it (--restart), or choose another output folder",
        path = .path.display()
    )]
    OtherScene { path: PathBuf, changed: String },
    #[error(
        "{path} is not the run of this scene, {changed} changed since: design it again (`kirigami design --restart`), or \
         name the file with --design to take its design nevertheless",
        path = .path.display()
    )]
    Outdated { path: PathBuf, changed: String },
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
pub fn stored_design(path: &Path, scene: &Scene) -> Result<DesignVector, InverseDesignError> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Stored {
        Run { best: DesignVector },
        Alone(DesignVector),
    }
    let text = regular_file::read(path).map_err(FileError::at(path))?;
    let stored = sealed_json::from_slice_by_hand(&text)
        .map_err(|source| InverseDesignError::State { path: path.to_owned(), source })?;
    let (Stored::Run { best: design } | Stored::Alone(design)) = stored;
    if design.same_shape(&scene.start()) {
        return Ok(design);
    }
    let path = path.to_owned();
    Err(InverseDesignError::OtherSize { path })
}

/// The best design of the run in the scene's run folder; `None` if there is no run.
///
/// It is an error if the run is of another scene or model.
pub fn design_of_run(scene: &Scene) -> Result<Option<DesignVector>, InverseDesignError> {
    let path = scene.output().join(STATE_FILE);
    let Some(state) = RunState::load(&path)? else {
        return Ok(None);
    };
    if let Some(changed) = state.changes(scene, &SEARCH_KEYS) {
        return Err(InverseDesignError::Outdated { path, changed });
    }
    if state.search.fits(&scene.start()) {
        Ok(Some(state.search.best))
    } else {
        Err(InverseDesignError::OtherSize { path })
    }
}

/// How the run in the scene's run folder was left, and its best design; `None` if there is no run.
///
/// It is an error if the run is of another scene or model.
pub fn left_run(scene: &Scene) -> Result<Option<(Ended, DesignVector)>, InverseDesignError> {
    let state = RunState::read(&scene.output().join(STATE_FILE), scene)?;
    Ok(state.map(|state| (state.left(), state.search.best)))
}

/// The keys of a scene by which a design is found. They change neither its sheet nor how it
/// deploys.
const SEARCH_KEYS: [&str; 3] = ["objective", "optimiser", "tolerances"];

/// The searches at coarser levels that found the start of a run.
#[derive(Default)]
pub struct Earlier {
    /// What is kept of them, the coarsest first.
    pub searches: Vec<CoarseSearch>,
    /// The last one, with whose optimiser the run begins.
    pub optimiser: Option<SearchState>,
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
    /// The start of a scene before any step of its search, with its path followed from the flat
    /// sheet until `stop` becomes true.
    pub fn at_start(scene: &Scene, stop: Arc<AtomicBool>) -> Result<Self, InverseDesignError> {
        let run = BegunRun::new(scene.clone(), Some(stop))?;
        let search = run.begun();
        run.designed(Ended::Stopped, search, Vec::new())
    }

    /// The run in the run folder of a scene as it was left, with its paths followed from the flat
    /// sheet until `stop` becomes true; `None` if there is no run.
    pub fn of_run(
        scene: &Scene,
        stop: Arc<AtomicBool>,
    ) -> Result<Option<Self>, InverseDesignError> {
        let Some(state) = RunState::read(&scene.output().join(STATE_FILE), scene)? else {
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
    pub fn new(scene: Scene, stop: Option<Arc<AtomicBool>>) -> Result<Self, InverseDesignError> {
        let mut problem = scene.problem()?;
        if let Some(stop) = stop {
            problem.stop_by(stop);
        }
        let start = problem.evaluate(&scene.start()).map_err(InverseDesignError::Start)?;
        Ok(Self { scene, problem, start })
    }

    /// The search at its start.
    pub fn begun(&self) -> SearchState {
        let (optimiser, start) = (&self.scene.config.optimiser, self.scene.start());
        let (method, rate) = (optimiser.method, optimiser.learning_rate);
        SearchState::new(&self.problem, start, &self.start, method, rate)
    }

    /// Runs the search in the run folder of the scene, `until` then or to all steps of the scene;
    /// continues from the state there if there is one.
    ///
    /// `progress` is called after every step; the run stops at the end
    /// of the step during which `stop` becomes true.
    pub fn search(
        self,
        earlier: &Earlier,
        until: Option<Until>,
        stop: &AtomicBool,
        progress: OnStep,
    ) -> Result<Designed, InverseDesignError> {
        let Self { scene, problem, start } = &self;
        let (level, steps) = (scene.config.level, scene.config.optimiser.steps);
        let until = until.unwrap_or(steps.into());
        let folder = scene.output();
        std::fs::create_dir_all(&folder).map_err(FileError::at(&folder))?;
        let path = folder.join(STATE_FILE);
        wide_enough(scene, start)?;
        let (searches, mut search) = match RunState::read(&path, scene)? {
            Some(state) => (state.coarse_searches, state.search),
            None => {
                let search = match &earlier.optimiser {
                    Some(coarser) => SearchState::after(coarser, problem, scene.start(), start),
                    None => self.begun(),
                };
                progress(level, &search);
                (earlier.searches.clone(), search)
            }
        };
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
            Ok::<_, FileError>(())
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
    ) -> Result<Designed, InverseDesignError> {
        let Self { scene, problem, start } = self;
        let best = match search.best == scene.start() {
            true => start.clone(),
            false => problem.evaluate(&search.best).map_err(InverseDesignError::Best)?,
        };
        Ok(Designed { scene, problem, ended, search, start, best, coarse_searches })
    }
}

/// Runs the search of a scene in its run folder; see [`BegunRun::search`].
pub fn inverse_design(
    scene: &Scene,
    stop: &AtomicBool,
    progress: &mut dyn FnMut(&SearchState),
) -> Result<Designed, InverseDesignError> {
    let run = BegunRun::new(scene.clone(), None)?;
    run.search(&Earlier::default(), None, stop, &mut |_, search| progress(search))
}

/// An error if a panel of the start is so thin that the barrier of the minimum width is infinite.
fn wide_enough(scene: &Scene, start: &Evaluation) -> Result<(), InverseDesignError> {
    let minimum = scene.config.objective.min_panel_width;
    let panels = start.deployment.sheet.panels.iter();
    let panels: Vec<_> = panels.map(|panel| panel.corners).collect();
    let thinnest = thinnest_panel(&panels);
    if minimum > 0.0 && thinnest <= minimum {
        return Err(InverseDesignError::ThinStart { thinnest, minimum });
    }
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

    /// The state in a file; `None` if there is no file.
    fn load(path: &Path) -> Result<Option<Self>, InverseDesignError> {
        let text = match regular_file::read(path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            text => text.map_err(FileError::at(path))?,
        };
        let state = sealed_json::from_slice(&text);
        state
            .map(Some)
            .map_err(|source| InverseDesignError::State { path: path.to_owned(), source })
    }

    /// The keys of the scene and the inputs besides that changed since the run, in words; those
    /// `allowed` may.
    fn changes(&self, scene: &Scene, allowed: &[&str]) -> Option<String> {
        let forbidden = |name: &&str| !allowed.contains(name);
        let keys = self.changed_keys(scene);
        let keys = keys.iter().map(String::as_str).filter(forbidden);
        let inputs = self.changed_inputs(scene).into_iter().filter(forbidden);
        let changed: Vec<String> = (keys.map(|key| format!("the key `{key}`")))
            .chain(inputs.map(|input| format!("the {input}")))
            .collect();
        (!changed.is_empty()).then(|| changed.join(", "))
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
    fn read(path: &Path, scene: &Scene) -> Result<Option<Self>, InverseDesignError> {
        let Some(state) = Self::load(path)? else {
            return Ok(None);
        };
        let path = path.to_owned();
        if let Some(changed) = state.changes(scene, &[]) {
            return Err(InverseDesignError::OtherScene { path, changed });
        }
        if !state.search.fits(&scene.start()) {
            return Err(InverseDesignError::OtherSize { path });
        }
        Ok(Some(state))
    }

    fn write(&self, path: &Path) -> Result<(), FileError> {
        let text = sealed_json::to_vec(self).map_err(FileError::at(path))?;
        whole_file::write(path, &text).map_err(FileError::at(path))
    }
}
