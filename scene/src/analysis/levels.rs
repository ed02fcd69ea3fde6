//! What each level of a scene costs, and by how much it differs from the finest one.

use crate::analysis::error_budget::{Cause, Contribution, ErrorBudget};
use crate::analysis::level_difference::{AtLevel, LevelError};
use crate::{Level, LevelDifference, Scene};
use design::objective::design_problem::DesignError;
use design::optimise::outer_loop::{SearchState, optimise};
use design::pattern::design_vector::DesignVector;
use serde::{Deserialize, Serialize};
use std::convert::Infallible;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Steps of a search that are timed: one whose path is followed, and those up to the next one.
const TIMED: usize = 10;
/// Steps of a search of a scene that has none, such as a run that evaluates a design.
const USUAL: usize = 100;

/// A level of a scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct LevelCost {
    /// The level.
    pub level: Level,
    /// Seconds of a step of its search, the mean of the first ten; `None` if there is no search.
    pub step: Option<f64>,
    /// Seconds of all steps of the scene, or of 100 if it has none, at that rate.
    pub search: Option<f64>,
    /// Load at the end of the path (N, or N mm), where the motion is prescribed.
    pub load: Option<f64>,
    /// The largest D_peak of a hinge along the path.
    pub damage: Option<f64>,
    /// The difference of the design to the finest level; `None` for that one.
    pub difference: Option<LevelDifference>,
    /// Why the design has no state at the level.
    pub failure: Option<String>,
}

/// The levels of a scene at one design.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Levels {
    /// The levels, from the cheapest to the finest.
    pub levels: Vec<LevelCost>,
    /// What no level buys: the causes of errors of the finest level other than its networks.
    pub others: Vec<Contribution>,
}

/// Measures every level that a scene has networks for, and those below. `progress` is called with
/// each before it is measured.
pub fn levels(
    scene: &Scene,
    design: &DesignVector,
    stop: &AtomicBool,
    progress: &mut dyn FnMut(Level),
) -> Result<Levels, LevelError> {
    let scenes = Level::ALL.into_iter();
    let scenes: Vec<Scene> = scenes.filter_map(|level| scene.at_level(level).ok()).collect();
    let finest = scenes.last().unwrap_or(scene);
    progress(finest.config.level);
    let reference = AtLevel::new(finest, design)?;
    let mut found = Vec::new();
    for scene in &scenes {
        let level = scene.config.level;
        progress(level);
        let mut design = design.clone();
        if level == Level::Pin {
            design.opening.get_or_insert(reference.deployment.final_step().mean_opening());
        }
        let step = seconds(scene, stop).ok();
        let own;
        let at = if level == reference.level {
            Ok(&reference)
        } else {
            own = AtLevel::new(scene, &design);
            own.as_ref()
        };
        let known = at.ok();
        let search = step.map(|step| step * steps(scene) as f64);
        found.push(LevelCost {
            level,
            step,
            search,
            load: known.and_then(AtLevel::load),
            damage: known.and_then(AtLevel::damage_peak),
            difference: (known.filter(|_| level != reference.level))
                .map(|at| at.difference(&reference)),
            failure: at.err().map(ToString::to_string),
        });
    }
    let budget = ErrorBudget::new(finest, &reference.problem, &reference.deployment, None);
    let others = budget.into_iter().flat_map(|budget| budget.contributions);
    Ok(Levels {
        levels: found,
        others: others.filter(|part| part.cause != Cause::Network).collect(),
    })
}

fn steps(scene: &Scene) -> usize {
    match scene.config.optimiser.steps {
        0 => USUAL,
        steps => steps,
    }
}

/// Seconds of a step of the search from the start of a scene.
fn seconds(scene: &Scene, stop: &AtomicBool) -> Result<f64, LevelError> {
    let level = scene.config.level;
    let failed = |source: DesignError| LevelError::Design { level, source };
    let (problem, start) = (scene.problem()?, scene.start());
    let optimiser = &scene.config.optimiser;
    let begin = Instant::now();
    let evaluation = problem.evaluate(&start).map_err(failed)?;
    let (method, rate) = (optimiser.method, optimiser.learning_rate);
    let mut search = SearchState::new(&problem, start, &evaluation, method, rate);
    let last = TIMED.min(steps(scene)) - 1;
    let searched = optimise(&problem, &mut search, last, stop, &mut |_| Ok::<_, Infallible>(()));
    let Ok(_) = searched;
    Ok(begin.elapsed().as_secs_f64() / search.history.len() as f64)
}
