//! `kirigami deploy`: the ideal deployment of a design in numbers.

use crate::inspect::Listed;
use anyhow::{Context, Result};
use clap::Args;
use design::listing::DeploymentListing;

/// A scene's sheet opened by its kinematics alone, every hinge by the same angle
///
/// Example: kirigami deploy configs/scenes/linear-7x7.toml --opening-deg 60 --json
#[derive(Args)]
pub struct DeployCommand {
    #[command(flatten)]
    listed: Listed,
    /// Opening of the hinges (deg); by default the design's, if the scene's hinges are pins
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    opening_deg: Option<f64>,
}

impl DeployCommand {
    pub fn run(&self) -> Result<()> {
        let (scene, design) = self.listed.read()?;
        let opening = (self.opening_deg.map(f64::to_radians))
            .or(design.opening)
            .context("this scene's hinges are no pins: give --opening-deg")?;
        let listing = DeploymentListing::new(&scene.problem()?, &design, opening)?;
        self.listed.print(listing)
    }
}
