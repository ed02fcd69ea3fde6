//! `kirigami inspect pattern`: the flat sheet of a design in numbers.

use crate::commands::inspect::scene_args::Listed;
use anyhow::Result;
use clap::Args;
use output::listing::PatternListing;

/// Print cut endpoints, panels and hinges of a scene's sheet, and whether it is valid
///
/// Example: kirigami inspect pattern configs/scenes/linear-7x7.toml --json
#[derive(Args)]
pub struct PatternCommand {
    #[command(flatten)]
    listed: Listed,
}

impl PatternCommand {
    pub fn run(&self) -> Result<()> {
        let (scene, design) = self.listed.read()?;
        let listing = PatternListing::new(&scene.problem()?, &design)?;
        self.listed.print(listing)
    }
}
