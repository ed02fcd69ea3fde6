//! `kirigami database retry`

use super::CampaignArgs;
use anyhow::Result;
use clap::Args;
use fe_driver::FailureKind;

/// Reopen rays that failed or ended early, for the next run to try again
///
/// For what has changed since and is no setting of the job: more memory, a longer time limit of a
/// solve, a solver that was broken.
#[derive(Args)]
pub struct RetryCommand {
    #[command(flatten)]
    campaign: CampaignArgs,
    /// Only those that failed so, for example timed-out
    #[arg(long, value_name = "FAILURE")]
    only: Option<FailureKind>,
}

impl RetryCommand {
    pub fn run(&self) -> Result<()> {
        let reopened = fe_driver::retry(&self.campaign.folder(), self.only)?;
        println!("{reopened} rays reopened");
        Ok(())
    }
}
