//! `kirigami verify --equilibrium --polish`: the polished design, with the files of a run.

use crate::commands::design::write_run;
use crate::commands::verify::sheet_errors;
use crate::replays::balanced_sheet::WindowSolves;
use crate::replays::polish::{PolishGain, polish};
use crate::ui::progress::Progress;
use crate::ui::{interrupt, run_folder};
use anyhow::Result;
use design::optimise::outer_loop::StepRecord;
use design::pattern::design_vector::DesignVector;
use design::scene::Scene;
use std::num::NonZeroUsize;

/// Polishes a design, which has a name for a person, and writes `polish.md`, `equilibrium.md`, `design.json` and the
/// results of a run to the scene's output folder.
pub(super) fn run(
    scene: &Scene,
    (design, name): (&DesignVector, String),
    windows: &WindowSolves,
    rounds: usize,
    steps: NonZeroUsize,
    force: bool,
) -> Result<PolishGain> {
    let stop = interrupt::stop_flag()?;
    let bar = Progress::new(steps.get(), "design steps");
    let polished = polish(
        scene,
        (design, &name),
        windows,
        rounds,
        steps.get(),
        stop,
        &mut |step: &StepRecord| {
            let outline = step.scores.outline_error;
            bar.show(step.step, None, &format!("outline {outline:.2} mm"));
        },
    )?;
    bar.finish();
    sheet_errors::write(&polished.after, format!("polished {name}"), windows)?;
    let json = serde_json::to_string(&polished.designed.design)?;
    run_folder::write(windows.folder, "design.json", &json)?;
    write_run(scene, &polished.designed, force)?;
    run_folder::write(windows.folder, "polish.md", &polished.gain.to_string())?;
    Ok(polished.gain)
}
