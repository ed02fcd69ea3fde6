//! The choices of a scene, varied one at a time, and what each costs.

use anyhow::{Context, Result};
use design::objective::design_problem::DesignProblem;
use design::pattern::design_vector::DesignVector;
use design::scene::{CondensedConfig, HingeModel, SceneConfig};
use design::sheet::cut_sheet::HingePoint;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// A scene in which one choice differs from the scene as it is.
#[derive(Clone)]
pub struct Choice {
    pub kind: &'static str,
    pub name: String,
    pub config: SceneConfig,
}

/// The choices of one scene.
pub struct Choices {
    base: SceneConfig,
    pub list: Vec<Choice>,
}

impl Choices {
    pub fn new(base: &SceneConfig) -> Self {
        Self {
            base: base.clone(),
            list: Vec::new(),
        }
    }

    /// Adds a choice.
    pub fn vary(
        &mut self,
        kind: &'static str,
        name: impl Into<String>,
        change: impl FnOnce(&mut SceneConfig),
    ) {
        let (name, mut config) = (name.into(), self.base.clone());
        change(&mut config);
        self.list.push(Choice { kind, name, config });
    }

    /// Adds linear springs with the secant stiffness of `weights` at an angle (deg), attached at a hinge point.
    pub fn springs(
        &mut self,
        kind: &'static str,
        name: &str,
        weights: &Path,
        secant_deg: f64,
        point: HingePoint,
    ) {
        self.vary(kind, name, |config| {
            config.hinge = HingeModel::Linear;
            config.hinge_point = Some(point);
            config.surrogate = None;
            // Only a learned law has damage and a domain.
            (config.objective.damage, config.objective.domain) = (0.0, 0.0);
            config.condensed = Some(CondensedConfig {
                weights: weights.to_owned(),
                secant_deg,
            });
        });
    }
}

/// The weights of the scene at `scene`, as a path independent of its folder.
pub fn own_weights(config: &SceneConfig, scene: &Path) -> Result<PathBuf> {
    let named = config.surrogate.as_ref();
    let named = &named
        .context("the scene has no weights: add surrogate.weights")?
        .weights;
    let folder = scene.parent().unwrap_or(Path::new(""));
    Ok(std::path::absolute(folder.join(named))?)
}

/// CPU time of an equilibrium path with the gradient of the objective (s).
pub fn step_seconds(problem: &DesignProblem, design: &DesignVector) -> Result<f64> {
    Ok(cost(|| problem.evaluate(design).map(drop))?)
}

/// A cost is the mean over the repeats within this time, with a minimum number of repeats.
const REPEAT: Duration = Duration::from_millis(500);
const MIN_REPEATS: u32 = 5;

/// Seconds per repeat: CPU time of this thread if the system reports it, otherwise wall time.
fn cost<E>(mut work: impl FnMut() -> Result<(), E>) -> Result<f64, E> {
    let (begin, busy, mut repeats) = (Instant::now(), thread_seconds(), 0);
    while begin.elapsed() < REPEAT || repeats < MIN_REPEATS {
        work()?;
        repeats += 1;
    }
    let spent = match (busy, thread_seconds()) {
        (Some(before), Some(after)) => after - before,
        _ => begin.elapsed().as_secs_f64(),
    };
    Ok(spent / f64::from(repeats))
}

/// CPU time of this thread from the kernel (s), which counts in ticks of a few milliseconds.
fn thread_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(1e-9 * nanoseconds)
}
