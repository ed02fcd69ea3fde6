//! `kirigami inspect`: the numbers of the stages of a design.

#[cfg(feature = "pipeline")]
pub(crate) mod judged_design;
pub mod scene_args;

use crate::commands::inspect::scene_args::Listed;
use anyhow::{Context, Result};
use clap::{Args, Subcommand};
use output::listing::{DeploymentListing, EquilibriumListing, GradientListing, PatternListing};

/// Print the numbers of one stage of a design: pattern, deploy, equilibrium, gradient
#[derive(Args)]
pub struct InspectCommand {
    #[command(subcommand)]
    stage: Stage,
}

#[derive(Subcommand)]
enum Stage {
    /// Print cut endpoints, panels and hinges of a scene's sheet, and whether it is valid
    ///
    /// Example: kirigami inspect pattern configs/scenes/linear-7x7.toml --json
    Pattern(Listed),
    /// Print the kinematic deployment of a scene's sheet, with the same opening angle at every hinge
    ///
    /// Example: kirigami inspect deploy configs/scenes/linear-7x7.toml --opening-deg 60 --json
    Deploy(DeployArgs),
    /// Print the equilibria of a scene's sheet along its equilibrium path, and how each was solved
    ///
    /// Example: kirigami inspect equilibrium configs/scenes/linear-7x7.toml --json
    Equilibrium(Listed),
    /// Print the objective of a scene's sheet, term by term, and its gradient
    ///
    /// Example: kirigami inspect gradient configs/scenes/linear-7x7.toml --json
    Gradient(Listed),
}

#[derive(Args)]
struct DeployArgs {
    #[command(flatten)]
    listed: Listed,
    /// Opening angle of the hinges (deg) [default: that of the design, if the scene has pin hinges]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    opening_deg: Option<f64>,
}

impl InspectCommand {
    pub(crate) fn run(&self) -> Result<()> {
        match &self.stage {
            Stage::Pattern(listed) => {
                let (scene, design, name) = listed.read()?;
                listed.print(name, PatternListing::new(&scene.problem()?, &design)?)
            }
            Stage::Deploy(DeployArgs {
                listed,
                opening_deg,
            }) => {
                let (scene, design, name) = listed.read()?;
                let problem = scene.problem()?;
                let opening = (opening_deg.map(f64::to_radians))
                    .or(problem.opening(&design))
                    .context("this scene's hinges are not pins: pass --opening-deg")?;
                listed.print(name, DeploymentListing::new(&problem, &design, opening)?)
            }
            Stage::Equilibrium(listed) => {
                let (scene, design, name) = listed.read()?;
                listed.print(name, EquilibriumListing::new(&scene.problem()?, &design)?)
            }
            Stage::Gradient(listed) => {
                let (scene, design, name) = listed.read()?;
                listed.print(
                    name,
                    GradientListing::new(&scene, &scene.problem()?, &design)?,
                )
            }
        }
    }
}
