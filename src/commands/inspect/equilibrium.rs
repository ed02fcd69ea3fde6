//! `kirigami inspect equilibrium`: the equilibrium path of a design in numbers.

use crate::commands::inspect::scene_args::Listed;
use anyhow::Result;
use clap::Args;
use output::listing::EquilibriumListing;

/// Print the equilibria of a scene's sheet along its equilibrium path, and how each was solved
///
/// Example: kirigami inspect equilibrium configs/scenes/linear-7x7.toml --json
#[derive(Args)]
pub struct EquilibriumCommand {
    #[command(flatten)]
    listed: Listed,
}

impl EquilibriumCommand {
    pub fn run(&self) -> Result<()> {
        let (scene, design) = self.listed.read()?;
        let listing = EquilibriumListing::new(&scene.problem()?, &design)?;
        self.listed.print(listing)
    }
}
