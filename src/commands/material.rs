//! `kirigami material`: the sheet material, from tensile tests to a checked material file.

mod check;
mod fit;

use anyhow::Result;
use clap::{Args, Subcommand};

/// Fit a material file to tensile tests, and check a material
#[derive(Args)]
pub struct MaterialCommand {
    #[command(subcommand)]
    action: Action,
}

#[derive(Subcommand)]
enum Action {
    Fit(fit::FitCommand),
    Check(check::CheckCommand),
}

impl MaterialCommand {
    pub(crate) fn run(&self) -> Result<()> {
        match &self.action {
            Action::Fit(command) => command.run(),
            Action::Check(command) => command.run(),
        }
    }
}
