//! `kirigami inspect`: the numbers of one stage of a design.

mod deploy;
mod equilibrium;
mod gradient;
#[cfg(feature = "pipeline")]
pub(crate) mod judged_design;
mod pattern;
pub mod scene_args;

use anyhow::Result;
use clap::{Args, Subcommand};

/// Print the numbers of one stage of a design: pattern, deploy, equilibrium, gradient
#[derive(Args)]
pub struct InspectCommand {
    #[command(subcommand)]
    stage: Stage,
}

#[derive(Subcommand)]
enum Stage {
    Pattern(pattern::PatternCommand),
    Deploy(deploy::DeployCommand),
    Equilibrium(equilibrium::EquilibriumCommand),
    Gradient(gradient::GradientCommand),
}

impl InspectCommand {
    pub(crate) fn run(&self) -> Result<()> {
        match &self.stage {
            Stage::Pattern(command) => command.run(),
            Stage::Deploy(command) => command.run(),
            Stage::Equilibrium(command) => command.run(),
            Stage::Gradient(command) => command.run(),
        }
    }
}
