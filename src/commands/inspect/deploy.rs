//! `kirigami inspect deploy`: the ideal deployment of a design in numbers.

use crate::commands::inspect::scene_args::Listed;
use anyhow::{Context, Result};
use clap::Args;
use output::listing::DeploymentListing;

/// Print the kinematic deployment of a scene's sheet, with the same opening angle at every hinge
///
/// Example: kirigami inspect deploy configs/scenes/linear-7x7.toml --opening-deg 60 --json
#[derive(Args)]
pub struct DeployCommand {
    #[command(flatten)]
    listed: Listed,
    /// Opening angle of the hinges (deg) [default: that of the design, if the scene has pin hinges]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    opening_deg: Option<f64>,
}

impl DeployCommand {
    pub fn run(&self) -> Result<()> {
        let (scene, design) = self.listed.read()?;
        let opening = (self.opening_deg.map(f64::to_radians))
            .or(design.opening)
            .context("this scene's hinges are not pins: pass --opening-deg")?;
        let listing = DeploymentListing::new(&scene.problem()?, &design, opening)?;
        self.listed.print(listing)
    }
}
