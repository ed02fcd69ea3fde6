//! `kirigami inspect gradient`: objective and gradient of a design in numbers.

use crate::commands::inspect::scene_args::Listed;
use anyhow::Result;
use clap::Args;
use output::listing::GradientListing;

/// Print the objective of a scene's sheet, term by term, and its gradient
///
/// Example: kirigami inspect gradient configs/scenes/linear-7x7.toml --json
#[derive(Args)]
pub struct GradientCommand {
    #[command(flatten)]
    listed: Listed,
}

impl GradientCommand {
    pub fn run(&self) -> Result<()> {
        let (scene, design) = self.listed.read()?;
        self.listed.print(GradientListing::new(&scene, &design)?)
    }
}
