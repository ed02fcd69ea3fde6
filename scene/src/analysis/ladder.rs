//! A design of the required accuracy, at the cheapest level that reaches it.
//!
//! The search runs at the cheapest learned level. The difference of the design it finds to the next
//! finer level estimates the error of the level. If it is larger than required, the search goes on
//! at the finer level from that design, and so on; otherwise the finer level evaluates the design,
//! and the run reports that evaluation.

use crate::analysis::error_budget::{Cause, ErrorBudget};
use crate::analysis::level_difference::{AtLevel, LevelError};
use crate::design_run::{Designed, InverseDesignError, design_after, inverse_design};
use crate::{Level, Scene, SceneError};
use design::optimise::outer_loop::{Ended, SearchState};
use std::sync::atomic::AtomicBool;

/// A design found on a ladder of levels.
pub struct Climbed {
    /// The scene of the finer level, which starts at the design.
    pub scene: Scene,
    /// The design at that level.
    pub designed: Designed,
}

/// Why no design is found.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum ClimbError {
    #[error(
        "an accuracy is measured by two learned levels, and the scene has {found}: name a smaller network (surrogate.draft) or \
         further ones (surrogate.ensemble), or design at one level (--level)"
    )]
    OneLevel { found: String },
    #[error(
        "{asked} mm is less than the rounding of a sheet of {size:.0} mm: ask for at least {least:.1e} mm"
    )]
    TooFine { asked: f64, size: f64, least: f64 },
    #[error(transparent)]
    Design(#[from] InverseDesignError),
    #[error(transparent)]
    Level(#[from] LevelError),
}

impl From<SceneError> for ClimbError {
    fn from(error: SceneError) -> Self {
        Self::Design(error.into())
    }
}

/// The smallest difference that can be required, over the size of the sheet: a hundred times the
/// residual of an equilibrium.
const LEAST: f64 = 1e-8;

/// Designs a scene to within `asked` (mm) of its panel corners. The searches below the last level
/// are runs in folders of its run folder, with the names of their levels. A search that is stopped
/// ends the ladder: its design is the one that is returned.
pub fn climb(
    scene: &Scene,
    asked: f64,
    stop: &AtomicBool,
    progress: &mut dyn FnMut(Level, &SearchState),
) -> Result<Climbed, ClimbError> {
    let levels = scene.learned_levels();
    let size = scene.config.sheet.outline().size();
    let least = LEAST * size;
    if asked < least {
        return Err(ClimbError::TooFine { asked, size, least });
    }
    if levels.len() < 2 {
        let found = match levels.first() {
            None => "no learned level".to_owned(),
            Some(level) => format!("`{level}` alone"),
        };
        return Err(ClimbError::OneLevel { found });
    }
    let mut rungs = Vec::new();
    let mut at = scene.clone();
    for pair in levels.windows(2) {
        let [level, finer] = [pair[0], pair[1]];
        let mut search = at.at_level(level)?;
        search.config.output = scene.config.output.join(level.name());
        let designed = inverse_design(&search, stop, &mut |state| progress(level, state))?;
        if designed.ended == Ended::Stopped {
            return Ok(Climbed { scene: search, designed });
        }
        let next = search.at_level(finer)?;
        let at_finer = AtLevel::new(&next, &designed.design)?;
        let own =
            AtLevel { level, deployment: designed.best.deployment, problem: designed.problem };
        let rung = own.rung(&designed.history, &at_finer, asked);
        let mut config = next.starting_at(&designed.design);
        config.output.clone_from(&scene.config.output);
        let enough = rung.suffices()
            || rung.difference.corners[1] <= mesh_error(&next, &at_finer).unwrap_or(0.0);
        rungs.push(rung);
        if enough {
            config.optimiser.steps = 0;
            at = next.changed(config)?;
            break;
        }
        at = next.changed(config)?;
    }
    let level = at.config.level;
    let designed = design_after(rungs, &at, stop, &mut |state| progress(level, state))?;
    Ok(Climbed { scene: at, designed })
}

/// The error of the panel corners by the mesh of the windows (mm, the largest), which no level
/// lowers; `None` if it is not known.
fn mesh_error(scene: &Scene, at_finer: &AtLevel) -> Option<f64> {
    let budget = ErrorBudget::new(scene, &at_finer.problem, &at_finer.deployment, None)?;
    let mesh = budget.contributions.into_iter();
    let mut mesh = mesh.filter(|part| part.cause == Cause::WindowMesh);
    Some(mesh.next()?.effect?.corners[1])
}
