//! `kirigami surrogate`: the card of exported weights, and their errors.

mod card;
mod test;

use anyhow::Result;
use clap::Args;

/// Show the card of exported weights, and measure their errors against finite elements
#[derive(Args)]
pub struct SurrogateCommand {
    #[command(subcommand)]
    action: Action,
}

subcommands! {
    enum Action {
        Card(card::CardCommand),
        Test(test::TestCommand),
    }
}

impl SurrogateCommand {
    pub(crate) fn run(&self) -> Result<()> {
        self.action.run()
    }
}
