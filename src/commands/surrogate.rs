//! `kirigami surrogate`: evaluate exported weights, and measure their errors.

mod card;
mod errors;
mod eval;
mod release;
mod spot_check;
mod test;

use anyhow::Result;
use clap::{Args, Subcommand};

/// Evaluate exported weights, and measure their errors against finite elements
#[derive(Args)]
pub struct SurrogateCommand {
    #[command(subcommand)]
    action: Action,
}

#[derive(Subcommand)]
enum Action {
    Eval(eval::EvalCommand),
    Card(card::CardCommand),
    Test(test::TestCommand),
    SpotCheck(spot_check::SpotCheckCommand),
    Release(release::ReleaseCommand),
}

impl SurrogateCommand {
    pub(crate) fn run(&self) -> Result<()> {
        match &self.action {
            Action::Eval(command) => command.run(),
            Action::Card(command) => command.run(),
            Action::Test(command) => command.run(),
            Action::SpotCheck(command) => command.run(),
            Action::Release(command) => command.run(),
        }
    }
}
