//! `kirigami material`: the sheet material, from tensile tests to a checked material file.

mod check;
mod fit;
#[cfg(feature = "pipeline")]
mod learn;

use anyhow::Result;
use clap::Args;

/// Fit a material file to tensile tests, check a material, and learn its hinge energy
#[derive(Args)]
pub struct MaterialCommand {
    #[command(subcommand)]
    action: Action,
}

subcommands! {
    enum Action {
        Fit(fit::FitCommand),
        Check(check::CheckCommand),
        #[cfg(feature = "pipeline")]
        Learn(learn::LearnCommand),
    }
}

impl MaterialCommand {
    pub(crate) fn run(&self) -> Result<()> {
        self.action.run()
    }
}
