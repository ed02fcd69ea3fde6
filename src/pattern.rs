//! `kirigami pattern`: the flat sheet of a design in numbers.

use crate::inspect::Listed;
use anyhow::Result;
use clap::Args;
use design::listing::PatternListing;

/// Cut endpoints, panels and hinges of a scene's sheet, and whether it is valid
///
/// Example: kirigami pattern configs/scenes/linear-7x7.toml --json
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
