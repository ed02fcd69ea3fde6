//! `kirigami verify --equilibrium --polish`: the polished design, with the files of a run.

use crate::commands::design::write_run;
use crate::commands::solve_args::task_error;
use crate::ui::progress::Progress;
use crate::ui::{interrupt, run_folder};
use anyhow::Result;
use design::optimise::outer_loop::StepRecord;
use std::path::Path;
use verification::{ElementWindows, PolishGain, PolishTask, SheetErrors, polish};

/// Polishes a design, and writes `polish.md`, `equilibrium.md`, `design.json` and the results of a run to the folder
/// `out`, which is also the scene's.
pub(super) fn run(
    task: PolishTask,
    windows: &ElementWindows,
    out: &Path,
    force: bool,
) -> Result<PolishGain> {
    let stop = interrupt::stop_flag()?;
    let bar = Progress::new(task.steps, "design steps");
    let show = &mut |step: &StepRecord| {
        let outline = step.scores.outline_error;
        bar.show(step.step, None, &format!("outline {outline:.2} mm"));
    };
    let polished = polish(task, windows, stop, show).map_err(task_error)?;
    bar.finish();
    let name = format!("polished {}", task.name);
    let budget = polished.after.budget(task.scene)?;
    let errors = SheetErrors::new(&polished.after, name, budget.as_ref());
    run_folder::write(out, "equilibrium.md", &errors.to_string())?;
    let json = serde_json::to_string(&polished.designed.design)?;
    run_folder::write(out, "design.json", &json)?;
    write_run(task.scene, &polished.designed, force)?;
    run_folder::write(out, "polish.md", &polished.gain.to_string())?;
    Ok(polished.gain)
}
