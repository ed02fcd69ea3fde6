//! The minimum of the loss at fixed openings: a family of solutions is a local minimum of this curve.

use anyhow::{Context, Result};
use design::optimise::outer_loop::{SearchState, optimise};
use design::optimise::search::SearchMethod;
use design::scene::{Scene, SceneConfig};
use kirigami::ui::interrupt;
use std::path::Path;

/// The openings (deg).
const OPENINGS: std::ops::RangeInclusive<usize> = 6..=26;
const STEP_DEG: f64 = 5.0;
/// Number of random starts at every opening.
const STARTS: u64 = 4;

/// The opening (deg), and the root of the minimum loss over the starts, relative to the sheet's side.
pub fn opening_profile(config: &SceneConfig, file: &Path, side: f64) -> Result<Vec<[f64; 2]>> {
    OPENINGS
        .map(|k| {
            let opening = STEP_DEG * k as f64;
            let losses = (0..STARTS).map(|start| minimum(config, file, opening, start));
            let losses = losses.collect::<Result<Vec<f64>>>()?;
            let minimum = losses.into_iter().fold(f64::INFINITY, f64::min);
            Ok([opening, minimum.sqrt() / side])
        })
        .collect()
}

/// The loss (mm^2) at which a search with a fixed opening ends.
fn minimum(config: &SceneConfig, file: &Path, opening_deg: f64, start: u64) -> Result<f64> {
    let mut config = config.clone();
    config.optimiser.seed += start;
    let pin = config.pin.as_mut();
    pin.context("the scene has no [pin]: set hinge = \"pin\"")?
        .opening_deg = opening_deg;
    let (steps, rate) = (config.optimiser.steps, config.optimiser.learning_rate);
    let scene = Scene::new(config, file)?;
    let problem = scene.problem()?;
    // A design without an opening of its own has that of the scene.
    let mut design = scene.start();
    design.opening = None;
    let evaluation = problem.evaluate(&design)?;
    let mut state = SearchState::new(&problem, design, &evaluation, SearchMethod::Lbfgs, rate);
    let stop = interrupt::stop_flag()?;
    optimise(&problem, &mut state, steps, stop, &mut |_| {
        Ok::<_, anyhow::Error>(())
    })?;
    let losses = state.history.iter().map(|step| step.scores.loss);
    Ok(losses.fold(f64::INFINITY, f64::min))
}
