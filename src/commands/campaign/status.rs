//! `kirigami campaign status`

use super::campaign_args::{CampaignArgs, print_tally};
use anyhow::Result;
use clap::Args;
use fe_driver::{ArrayStates, Status};
use serde::Serialize;

/// Print the state of the jobs, the reasons of failures, the throughput, and the tasks on a cluster
#[derive(Args)]
pub(crate) struct StatusCommand {
    #[command(flatten)]
    campaign: CampaignArgs,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Report {
    #[serde(flatten)]
    status: Status,
    /// The last submission to Slurm; null if there is none, or if Slurm does not answer.
    slurm: Option<ArrayStates>,
}

impl StatusCommand {
    pub(super) fn run(&self) -> Result<()> {
        let folder = self.campaign.folder();
        fe_driver::known_parts(&self.campaign.load()?, &folder)?;
        let status = fe_driver::status(&folder)?;
        let (slurm, silent) = match fe_driver::array_states(&folder) {
            Err(error) => (None, Some(error)),
            Ok(states) => (states, None),
        };
        if self.json {
            let report = Report { status, slurm };
            println!("{}", serde_json::to_string_pretty(&report)?);
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
        if let Some(states) = slurm {
            println!("{states}");
        }
        if let Some(error) = silent {
            println!("{error}");
        }
        Ok(())
    }
}
