//! `kirigami levels`: what every level of a scene costs, and how far it is from the finest.

use crate::{
    commands::inspect::scene_args::Inspected,
    ui::{interrupt, print_of},
};
use analysis::levels::levels;
use anyhow::Result;
use app::{design_checks::record, progress::announce};
use clap::Args;

/// Compare the levels of a scene: seconds of a search, and the difference to the finest level
///
/// Deploys the design of the scene's run, or its start design, at every level for which the scene
/// names networks and at those below, and times ten steps of the search at each. The difference to
/// the finest level is the estimate of a level's error. What no level lowers, such as the errors of
/// the mesh and of the material, is listed below the table. `kirigami design --within` chooses the
/// level by itself; docs/CHOOSE.md explains the levels; `kirigami verify` compares the finest one
/// with finite elements. Of the design of a run, report and page of the run are written again, with
/// the table. Example: kirigami levels configs/scenes/a4-plate.toml
#[derive(Args)]
pub struct LevelsCommand {
    #[command(flatten)]
    inspected: Inspected,
    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

impl LevelsCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let (scene, design, name) = self.inspected.chosen().read()?;
        let stop = interrupt::stop_flag()?;
        let found = levels(&scene, &design, stop, &mut |level| {
            announce(&format!("level {level}"));
        })?;
        print_of(self.json, &name, &found, found.document())?;
        if self.inspected.chosen().is_run(&scene) {
            record(&scene, &design, |checks| checks.levels = Some(found))?;
        }
        Ok(())
    }
}
