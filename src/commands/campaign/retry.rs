//! `kirigami campaign retry`

use crate::commands::campaign::campaign_args::CampaignArgs;
use anyhow::Result;
use clap::Args;
use fe_driver::FailureKind;

/// Reopen rays that failed or ended early, so that the next run solves them again
///
/// For use after a change that is not a setting of the job: more memory, a longer time limit per
/// solve, a repaired solver.
#[derive(Args)]
pub struct RetryCommand {
    #[command(flatten)]
    campaign: CampaignArgs,
    /// Reopen only rays with this failure, for example timed-out
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
