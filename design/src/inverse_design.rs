//! The outer loop, Algorithm 1: Adam or L-BFGS on theta = (z, ell, omega).
//!
//! A design whose sheet finds no equilibrium ends nothing: the step from the last design that had
//! one is halved until there is one again. The state is saved in the run folder about once a second
//! and at the end, and a run takes up there: steps depend on nothing but the scene, the files it names
//! and the state, so a run that was stopped follows the trajectory of one that was not.

use crate::backing_off::{MAX_HALVINGS, Setback, evaluate_or_back_off};
use crate::design_vector::DesignVector;
use crate::gradient::{DesignError, DesignProblem, Evaluation};
use crate::scene::{Scene, SceneConfig, SceneError};
use crate::scores::Scores;
use crate::search::Search;
use hinge::files;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

const SAVE_EVERY: Duration = Duration::from_secs(1);
const STATE_FILE: &str = "state.json";

/// What one step found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepRecord {
    /// 0 is the start.
    pub step: usize,
    #[serde(flatten)]
    pub scores: Scores,
    /// How often the step was halved, one that was given up included, and what had no value.
    pub halvings: u32,
    pub setback: Option<String>,
}

/// Why a run ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ended {
    /// All steps were made.
    Completed,
    /// It was asked to stop; the next run continues.
    Stopped,
    /// No step from the last design lowers the loss: a minimum, or a kink that L-BFGS cannot leave.
    Settled,
    /// No step from the last design, however small, leads to a design with an equilibrium.
    Stuck { reason: String },
}

/// A finished run.
pub struct Designed {
    pub ended: Ended,
    pub history: Vec<StepRecord>,
    /// The design of the least loss.
    pub design: DesignVector,
    pub start: Evaluation,
    pub best: Evaluation,
}

/// Why there is no run.
#[derive(Debug, thiserror::Error)]
pub enum InverseDesignError {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error("the start of the search cannot be evaluated: {0}")]
    Start(DesignError),
    #[error("the best design of the run cannot be evaluated again: {0}")]
    Best(DesignError),
    #[error("cannot use {path}: {source}", path = .path.display())]
    Folder {
        path: PathBuf,
        source: std::io::Error,
    },
    #[error(
        "{path} is neither the state of a run nor a design ({source}); give another, or restart the \
         run",
        path = .path.display()
    )]
    State {
        path: PathBuf,
        source: serde_json::Error,
    },
    #[error(
        "{path} holds a design of another size than the scene's; give another, or restart the run",
        path = .path.display()
    )]
    OtherSize { path: PathBuf },
    #[error(
        "{path} belongs to a run of another scene; restart it, or choose another output folder",
        path = .path.display()
    )]
    OtherScene { path: PathBuf },
    #[error(
        "{path} belongs to a run with other weights or another material: the search started from \
         a loss of {found}, not {expected}; restart it, or choose another output folder",
        path = .path.display()
    )]
    OtherModel {
        path: PathBuf,
        found: f64,
        expected: f64,
    },
}

impl InverseDesignError {
    /// Whether the run folder holds a run of something else than was asked for.
    pub fn is_of_another_run(&self) -> bool {
        matches!(
            self,
            Self::OtherSize { .. } | Self::OtherScene { .. } | Self::OtherModel { .. }
        )
    }
}

/// Everything that the next step depends on.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct State {
    scene: SceneConfig,
    /// The last design that was evaluated.
    design: DesignVector,
    /// What the search proposes next.
    proposal: DesignVector,
    search: Search,
    best: DesignVector,
    history: Vec<StepRecord>,
}

/// The design in a JSON file: the best of a run's state, or one written alone.
pub fn stored_design(path: &Path, scene: &Scene) -> Result<DesignVector, InverseDesignError> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Stored {
        Run { best: DesignVector },
        Alone(DesignVector),
    }
    let text = std::fs::read_to_string(path).map_err(|source| InverseDesignError::Folder {
        path: path.to_owned(),
        source,
    })?;
    let stored = serde_json::from_str(&text).map_err(|source| InverseDesignError::State {
        path: path.to_owned(),
        source,
    })?;
    let (Stored::Run { best: design } | Stored::Alone(design)) = stored;
    if design.same_shape(&scene.start()) {
        return Ok(design);
    }
    let path = path.to_owned();
    Err(InverseDesignError::OtherSize { path })
}

/// Runs the search of a scene in its run folder, from the state there if there is one.
///
/// `progress` hears of every step as it is made; the run stops after the step during which `stop`
/// becomes true.
pub fn inverse_design(
    scene: &Scene,
    stop: &AtomicBool,
    progress: &mut dyn FnMut(&StepRecord),
) -> Result<Designed, InverseDesignError> {
    let problem = scene.problem()?;
    let folder = scene.output();
    std::fs::create_dir_all(&folder).map_err(|source| InverseDesignError::Folder {
        path: folder.clone(),
        source,
    })?;
    let path = folder.join(STATE_FILE);
    let start = problem
        .evaluate(&scene.start())
        .map_err(InverseDesignError::Start)?;
    let mut state = match State::read(&path, scene, &start)? {
        Some(state) => state,
        None => {
            let mut state = State::new(scene);
            let design = scene.start();
            progress(state.accept(scene, design, &start, Setback::default()));
            state
        }
    };

    let mut saved = Instant::now();
    let ended = loop {
        if state.history.len() > scene.config.optimiser.steps {
            break Ended::Completed;
        }
        if stop.load(Ordering::Relaxed) {
            break Ended::Stopped;
        }
        match state.next(&problem) {
            Ok((design, evaluation, setback)) => {
                progress(state.accept(scene, design, &evaluation, setback));
            }
            Err(ended) => break ended,
        }
        if saved.elapsed() > SAVE_EVERY {
            state.write(&path)?;
            saved = Instant::now();
        }
    };
    state.write(&path)?;
    let best = problem
        .evaluate(&state.best)
        .map_err(InverseDesignError::Best)?;
    Ok(Designed {
        ended,
        history: state.history,
        design: state.best,
        start,
        best,
    })
}

/// Forgets an earlier run in the scene's run folder, so that the next one starts afresh.
pub fn forget(scene: &Scene) -> Result<(), InverseDesignError> {
    let path = scene.output().join(STATE_FILE);
    match std::fs::remove_file(&path) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
            Err(InverseDesignError::Folder { path, source })
        }
        _ => Ok(()),
    }
}

impl State {
    fn new(scene: &Scene) -> Self {
        let design = scene.start();
        Self {
            scene: scene.config.clone(),
            search: Search::new(&scene.config.optimiser, design.to_flat().len()),
            proposal: design.clone(),
            best: design.clone(),
            design,
            history: Vec::new(),
        }
    }

    /// Evaluates what is proposed, or as much of it as the search accepts, or why the run ends here.
    fn next(
        &mut self,
        problem: &DesignProblem,
    ) -> Result<(DesignVector, Evaluation, Setback), Ended> {
        let mut rejected = 0;
        loop {
            let proposal = self.proposal.clone();
            match evaluate_or_back_off(problem, &self.search, &self.design, proposal) {
                Ok((design, evaluation, mut setback)) => {
                    setback.halvings += rejected;
                    return Ok((design, evaluation, setback));
                }
                Err(reason) => match (self.search.retry(), reason) {
                    (Some(increment), _) => {
                        self.propose(&increment);
                        rejected += MAX_HALVINGS + 1;
                    }
                    (None, Some(reason)) => return Err(Ended::Stuck { reason }),
                    (None, None) => return Err(Ended::Settled),
                },
            }
        }
    }

    /// Takes an evaluated design as the current one and proposes the next.
    fn accept(
        &mut self,
        scene: &Scene,
        design: DesignVector,
        evaluation: &Evaluation,
        setback: Setback,
    ) -> &StepRecord {
        let least = self
            .history
            .iter()
            .map(|record| record.scores.loss)
            .fold(f64::INFINITY, f64::min);
        if evaluation.loss < least {
            self.best = design.clone();
        }
        let gradient = evaluation.gradient.to_flat();
        let x = design.to_flat();
        let increment = self.search.increment(&x, evaluation.loss, &gradient);
        self.design = design;
        self.propose(&increment);
        self.history.push(StepRecord {
            step: self.history.len(),
            scores: Scores::of(scene, evaluation),
            halvings: setback.halvings,
            setback: setback.reason,
        });
        &self.history[self.history.len() - 1]
    }

    fn propose(&mut self, increment: &[f64]) {
        let proposal: Vec<f64> = std::iter::zip(self.design.to_flat(), increment)
            .map(|(coordinate, increment)| coordinate + increment)
            .collect();
        self.proposal = self.design.with_flat(&proposal);
    }

    /// The state of an earlier run of the same scene, which may since ask for more steps.
    fn read(
        path: &Path,
        scene: &Scene,
        start: &Evaluation,
    ) -> Result<Option<Self>, InverseDesignError> {
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(source) => {
                let path = path.to_owned();
                return Err(InverseDesignError::Folder { path, source });
            }
        };
        let mut state: Self =
            serde_json::from_str(&text).map_err(|source| InverseDesignError::State {
                path: path.to_owned(),
                source,
            })?;
        state.scene.optimiser.steps = scene.config.optimiser.steps;
        if state.scene != scene.config {
            let path = path.to_owned();
            return Err(InverseDesignError::OtherScene { path });
        }
        let scene_start = scene.start();
        let n = scene_start.to_flat().len();
        let designs = [&state.design, &state.proposal, &state.best];
        let same_size = designs.iter().all(|design| design.same_shape(&scene_start));
        let path = path.to_owned();
        match state.history.first() {
            Some(first) if same_size && state.search.fits(n) => {
                if first.scores.loss != start.loss {
                    return Err(InverseDesignError::OtherModel {
                        path,
                        found: first.scores.loss,
                        expected: start.loss,
                    });
                }
                Ok(Some(state))
            }
            _ => Err(InverseDesignError::OtherSize { path }),
        }
    }

    fn write(&self, path: &Path) -> Result<(), InverseDesignError> {
        serde_json::to_vec_pretty(self)
            .map_err(std::io::Error::from)
            .and_then(|text| files::write(path, &text))
            .map_err(|source| InverseDesignError::Folder {
                path: path.to_owned(),
                source,
            })
    }
}
