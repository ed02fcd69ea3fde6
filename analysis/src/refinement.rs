//! A design within a tolerance of the panel corners, at the cheapest level that keeps it.
//!
//! The search begins at the cheapest learned level. When it has converged, or has made half of its
//! steps, the difference of its design to the next finer level estimates the error of the level. If
//! that is larger than the tolerance, the finer level continues from that design and with that
//! optimiser; if not, the search makes its other steps, and the finer level evaluates the design.

use crate::error_budget::{ErrorBudget, ErrorCause};
use crate::level_difference::AtLevel;
use design::optimise::outer_loop::{Ended, Until};
use scene::design_run::{BegunRun, Designed, Earlier, InverseDesignError, LEVELS, OnStep};
use scene::{Scene, SceneError};
use std::sync::atomic::AtomicBool;
use support::{Fault, refuse};

/// Why no design is found.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum RefinementError {
    #[error(transparent)]
    Fault(#[from] Fault),
    #[error(transparent)]
    Design(#[from] InverseDesignError),
}

impl From<SceneError> for RefinementError {
    fn from(error: SceneError) -> Self {
        Self::Design(error.into())
    }
}

/// The smallest tolerance over the size of the sheet: a hundred times the residual of an
/// equilibrium.
const LEAST: f64 = 1e-8;

/// Designs a scene to within a tolerance (mm) of its panel corners. The coarse searches are runs in
/// folders of its run folder, with the names of their levels. A search that is stopped ends it: its
/// design is the one that is returned.
pub fn refine(
    scene: &Scene,
    tolerance: f64,
    stop: &AtomicBool,
    progress: OnStep,
) -> Result<Designed, RefinementError> {
    let levels = scene.learned_levels();
    let size = scene.config.sheet.outline().size();
    let least = LEAST * size;
    if tolerance < least {
        refuse!(
            "{tolerance} mm is less than the rounding of a sheet of {size:.0} mm: ask for at least {least:.1e} mm"
        );
    }
    let ([coarsest], finer @ [_, ..]) = levels.split_at(levels.len().min(1)) else {
        let found = levels.first().map_or("no learned level".into(), |it| format!("`{it}` alone"));
        refuse!(
            "an accuracy is measured by two learned levels, and the scene has {found}: name a smaller network (surrogate.draft) \
     or further ones (surrogate.ensemble), or design at one level (--level)"
        );
    };
    let mut earlier = Earlier::default();
    let mut run = BegunRun::new(scene.at_level(*coarsest)?, None)?;
    for finer in finer {
        let (level, steps) = (run.scene.config.level, run.scene.config.optimiser.steps);
        run.scene.config.output = scene.config.output.join(LEVELS).join(level.name());
        let mut until = Some(Until { steps: steps.div_ceil(2), converged: true });
        loop {
            let designed = run.search(&earlier, until, stop, progress)?;
            if designed.ended == Ended::Stopped {
                return Ok(designed);
            }
            let made = designed.search.last().step;
            let next = designed.scene.at_level(*finer)?;
            let mut config = next.starting_at(&designed.search.best);
            config.output.clone_from(&scene.config.output);
            let mut next = BegunRun::new(next.changed(config)?, None)?;
            let own = AtLevel::new(level, &designed.problem, &designed.best.deployment);
            let next_level = AtLevel::new(*finer, &next.problem, &next.start.deployment);
            let coarse = own.coarse_search(&designed.search, &next_level, tolerance);
            let suffices = coarse.suffices()
                || coarse.difference.corners[1] <= mesh_error(&next).unwrap_or(0.0);
            if suffices && designed.ended == Ended::Completed && made < steps {
                until = None;
                let Designed { scene, problem, start, .. } = designed;
                run = BegunRun { scene, problem, start };
                continue;
            }
            earlier.searches.push(coarse);
            earlier.optimiser = Some(designed.search);
            if suffices {
                next.scene.config.optimiser.steps = 0;
                return Ok(next.search(&earlier, None, stop, progress)?);
            }
            run = next;
            break;
        }
    }
    Ok(run.search(&earlier, None, stop, progress)?)
}

/// The error of the panel corners by the mesh of the windows (mm, the largest), which no level
/// lowers; `None` if it is unknown.
fn mesh_error(run: &BegunRun) -> Option<f64> {
    let budget = ErrorBudget::new(&run.scene, &run.problem, &run.start.deployment, None)?;
    let mut mesh = budget.contributions.into_iter();
    Some(mesh.find(|part| part.cause == ErrorCause::WindowMesh)?.effect?.corners[1])
}
