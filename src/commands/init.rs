//! `kirigami init`

use crate::new_project::NewProject;
use anyhow::Result;
use clap::Args;

/// Create a folder with material, campaign, training and scene for a sheet of your own
///
/// Ligament widths, windows, number of panels, stroke and target are scaled to the thickness and
/// the size of the sheet. A sheet that is large for its thickness has wide ligaments that fold, and
/// is held flat; from 2 mm on, others have ligaments narrower than the thickness, and bend in their
/// plane. The files run as they are: with a material that has weights, `design` at once; with
/// another, after its campaign and training. README.md in the folder lists the commands. With
/// --stock the sheet is as large as its cuts fit on a sheet of that stock. Examples: kirigami init
/// my-sheet --thickness 3 --size 210x297; kirigami init first --stock a4 --margin 5; kirigami init
/// film --thickness 0.1; kirigami init leaf --thickness 2 --size 300x300 --target
/// configs/targets/leaf.svg
#[derive(Args)]
pub struct InitCommand {
    #[command(flatten)]
    project: NewProject,
}

impl InitCommand {
    pub(crate) fn run(&self) -> Result<()> {
        println!("{}", self.project.create()?);
        Ok(())
    }
}
