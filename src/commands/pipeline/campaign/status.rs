//! `kirigami campaign status`

use super::campaign_args::{CampaignArgs, print_tally};
use anyhow::Result;
use clap::Args;

/// Print the state of the jobs, the reasons of failures, and the throughput
#[derive(Args)]
pub(crate) struct StatusCommand {
    #[command(flatten)]
    campaign: CampaignArgs,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl StatusCommand {
    pub(super) fn run(&self) -> Result<()> {
        let folder = self.campaign.folder();
        fe_driver::known_parts(&self.campaign.load()?, &folder)?;
        let status = fe_driver::status(&folder)?;
        if self.json {
            println!("{}", serde_json::to_string_pretty(&status)?);
            return Ok(());
        }
        print_tally(&status.tally);
        if let Some(pace) = &status.throughput {
            println!(
                "{:.0} rays and {:.0} samples per processor hour; {:.2} CPU s per sample; \
                 {:.1} % of the time outside the solver",
                pace.rays_per_hour,
                pace.samples_per_hour,
                pace.cpu_seconds_per_sample,
                100.0 * pace.overhead
            );
        }
        Ok(())
    }
}
