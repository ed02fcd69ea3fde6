//! The command line arguments that select a campaign, and the printed job counts.

use anyhow::Result;
use app::progress::duration;
use clap::Args;
use fe_driver::{Campaign, Tally};
use std::path::{Path, PathBuf};
use support::table::Table;

/// File of the database in the folder of a campaign.
pub(crate) const DATABASE: &str = "hinges.parquet";
/// File of the states on which weights are tested.
pub(crate) const SPOT_CHECK: &str = "spot-check.parquet";

/// A campaign and the folder of its jobs.
#[derive(Args)]
pub(super) struct CampaignArgs {
    /// Campaign (TOML), for example configs/campaigns/demo.toml
    #[arg(value_name = "CAMPAIGN")]
    pub campaign: PathBuf,
    /// Folder of the jobs [default: runs/<name of the campaign file>]
    #[arg(long, value_name = "FOLDER")]
    pub folder: Option<PathBuf>,
}

impl CampaignArgs {
    pub(super) fn load(&self) -> Result<Campaign> {
        Ok(Campaign::load(&self.campaign)?)
    }

    pub(super) fn folder(&self) -> PathBuf {
        self.folder.clone().unwrap_or_else(|| {
            Path::new("runs").join(self.campaign.file_stem().unwrap_or_default())
        })
    }
}

/// Prints the job counts and the reasons of failures.
pub(super) fn print_tally(tally: &Tally) {
    println!(
        "{} rays complete, {} partial, {} failed, {} to retry, {} open; {} samples; {} solver time",
        tally.complete,
        tally.partial,
        tally.failed,
        tally.retry,
        tally.open,
        tally.rows,
        duration(tally.cpu_seconds)
    );
    if tally.damaged > 0 {
        println!(
            "{} of the open rays have damaged files: the next run solves them again (`campaign plan` names the damage)",
            tally.damaged
        );
    }
    if !tally.failures.is_empty() {
        let mut failures = Table::new(["last failure", "rays"]);
        for (reason, count) in &tally.failures {
            failures.row([reason.to_string(), count.to_string()]);
        }
        println!("{failures}");
    }
    for (job, tier) in &tally.other_tiers {
        println!("ray {job} was solved on the mesh {tier}");
    }
}
