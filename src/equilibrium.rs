//! `kirigami equilibrium`: the load path of a design in numbers.

use crate::inspect::Listed;
use anyhow::Result;
use clap::Args;
use design::listing::EquilibriumListing;

/// Equilibria of a scene's sheet along its load path, with how each was found
///
/// Example: kirigami equilibrium configs/scenes/linear-7x7.toml --json
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
