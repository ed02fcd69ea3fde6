//! The design of a scene that a study evaluates.

use anyhow::{Result, bail};
use design::optimise::outer_loop::{Ended, StepRecord};
use design::scene::Scene;
use design::scene::design_run::{Designed, inverse_design};
use kirigami::ui::exit::Unfinished;
use kirigami::ui::interrupt;
use output::run_results::remove_run;

/// The finished search of a scene; a search that was stopped or is stuck is an error.
pub fn designed(scene: &Scene, progress: &mut dyn FnMut(&StepRecord)) -> Result<Designed> {
    let stop = interrupt::stop_flag()?;
    let designed = match inverse_design(scene, stop, &mut |search| progress(search.last())) {
        // A run of other weights or of a changed scene, left by an earlier study, is discarded.
        Err(error) if error.is_of_another_run() => {
            remove_run(scene)?;
            inverse_design(scene, stop, &mut |search| progress(search.last()))?
        }
        designed => designed?,
    };
    let title = &scene.config.title;
    match &designed.ended {
        Ended::Completed | Ended::Settled => Ok(designed),
        Ended::Stopped => bail!(Unfinished::new(
            scene.config.optimiser.steps + 1 - designed.history.len(),
            "design steps"
        )),
        Ended::Stuck { reason } => bail!("{title}: the search is stuck: {reason}"),
    }
}
