//! A design that is searched for at several levels.
//!
//! The search makes its steps at the cheapest learned level. The next finer level continues from
//! the design, with the optimiser, until it has converged. The movement of the panel corners from
//! one level to the next is the error of the search there: with a tolerance the first level that
//! keeps it is the last, and the next finer one evaluates the design alone.

use crate::error_budget::{ErrorBudget, ErrorCause};
use crate::level_difference::AtLevel;
use design::objective::design_problem::Deployment;
use design::optimise::outer_loop::Ended;
use scene::design_run::{BegunRun, Designed, Earlier, LEVELS, OnStep, left_run};
use scene::{Level, Scene};
use std::sync::atomic::{AtomicBool, Ordering};
use support::{Fault, at, refuse};

/// The smallest tolerance over the size of the sheet: a hundred times the residual of an
/// equilibrium.
const LEAST: f64 = 1e-8;

/// Designs a scene at its level. The search of a scene at `standard` or `fine` begins at its
/// cheapest learned level.
pub fn inverse_design(
    scene: &Scene,
    stop: &AtomicBool,
    progress: OnStep,
) -> Result<Designed, Fault> {
    let own = scene.config.level;
    let coarser = |level: &Level| *level < own && own < Level::Final;
    let coarse = scene.learned_levels().into_iter().find(coarser);
    let searches = scene.config.optimiser.steps > 0 && !stop.load(Ordering::Relaxed);
    let is_new = left_run(scene)?
        .is_none_or(|(ended, search)| ended == Ended::Stopped && search.last().step == 0);
    match coarse {
        Some(coarse) if searches && is_new => search(scene, &[coarse, own], None, stop, progress),
        _ => search(scene, &[own], None, stop, progress),
    }
}

/// Designs a scene to within a tolerance (mm) of its panel corners, at the cheapest learned level
/// that keeps it.
pub fn refine(
    scene: &Scene,
    tolerance: f64,
    stop: &AtomicBool,
    progress: OnStep,
) -> Result<Designed, Fault> {
    let levels = scene.learned_levels();
    let size = scene.config.sheet.outline().size();
    let least = LEAST * size;
    if tolerance < least {
        refuse!(
            "{tolerance} mm is less than the rounding of a sheet of {size:.0} mm: ask for at least {least:.1e} mm"
        );
    }
    if levels.len() < 2 {
        let found = levels.first().map_or("no learned level".into(), |it| format!("`{it}` alone"));
        refuse!(
            "an accuracy is measured by two learned levels, and the scene has {found}: name a smaller network (surrogate.draft) \
             or further ones (surrogate.ensemble), or design at one level (--level)"
        );
    }
    search(scene, &levels, Some(tolerance), stop, progress)
}

/// Searches at one level after the other, until one keeps the tolerance (mm) or the last has
/// converged. The runs of the levels but the last are in folders of the run folder, with their
/// names. A search that is stopped ends it.
pub fn search(
    scene: &Scene,
    levels: &[Level],
    tolerance: Option<f64>,
    stop: &AtomicBool,
    progress: OnStep,
) -> Result<Designed, Fault> {
    let begin = |level: Level| match level == scene.config.level {
        true => BegunRun::new(scene.clone(), None),
        false => scene
            .at_level(level)
            .and_then(|scene| BegunRun::new(scene, None))
            .map_err(at(&format!("at `{level}` (--level searches at one level alone)"))),
    };
    let mut earlier = Earlier::default();
    let mut run = begin(levels[0])?;
    for &finer in &levels[1..] {
        let level = run.scene.config.level;
        run.scene.config.output = scene.config.output.join(LEVELS).join(level.name());
        let designed = run.search(&earlier, None, stop, progress)?;
        let stopped = designed.ended == Ended::Stopped;
        if stopped && Some(&finer) != levels.last() {
            return Ok(designed);
        }
        run = begin(finer)?;
        let evaluation = run.problem.evaluate(&designed.search.best);
        // What helps at one level alone is not continued.
        let Some(evaluation) = evaluation.ok().filter(|found| found.loss <= run.start.loss) else {
            continue;
        };
        let [own, at_finer] = [
            AtLevel::new(level, &designed.problem, &designed.best.deployment),
            AtLevel::new(finer, &run.problem, &evaluation.deployment),
        ];
        let mesh = tolerance.and_then(|_| mesh_error(&run, &evaluation.deployment));
        let mesh = mesh.unwrap_or(0.0);
        let coarse = own.coarse_search(&designed.search, &at_finer, tolerance, mesh);
        let suffices = coarse.suffices() && !stopped;
        earlier.searches.push(coarse);
        earlier.last = Some(designed.search);
        if suffices {
            return run.search(&earlier, Some(0.into()), stop, progress);
        }
    }
    run.search(&earlier, None, stop, progress)
}

/// The error of the panel corners by the mesh of the windows (mm, the largest), which no level
/// lowers; `None` if it is unknown.
fn mesh_error(run: &BegunRun, deployment: &Deployment) -> Option<f64> {
    let budget = ErrorBudget::new(&run.scene, &run.problem, deployment, None)?;
    let mut mesh = budget.contributions.into_iter();
    Some(mesh.find(|part| part.cause == ErrorCause::WindowMesh)?.effect?.corners[1])
}
