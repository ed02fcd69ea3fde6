//! `kirigami campaign collect`

use crate::commands::campaign::campaign_args::CampaignArgs;
use anyhow::{Context, Result, bail};
use clap::Args;
use dataset::{Collected, SplitPlan};
use fe_driver::{Tally, finished_windows};
use std::path::PathBuf;
use verification::rows;

/// Collect the samples of all finished jobs in a Parquet file with its manifest
#[derive(Args)]
pub struct CollectCommand {
    #[command(flatten)]
    campaign: CampaignArgs,
    /// Parquet file to write [default: hinges.parquet in the folder of the jobs]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Collect even if some jobs are not finished
    #[arg(long)]
    partial: bool,
    /// Replace an existing Parquet file
    #[arg(long)]
    replace: bool,
}

impl CollectCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let folder = self.campaign.folder();
        fe_driver::refuse_changed(&self.campaign.load()?, &folder)?;
        let tally = fe_driver::status(&folder)?.tally;
        let missing = missing(&tally);
        if tally.to_run() > 0 && !self.partial {
            bail!(
                "{missing} in {}: run the campaign, or pass --partial to collect without them",
                folder.display()
            );
        }
        let out = self
            .out
            .clone()
            .unwrap_or_else(|| folder.join("hinges.parquet"));
        if let Some(parent) = out.parent() {
            std::fs::create_dir_all(parent)
                .with_context(|| format!("cannot create the folder {}", parent.display()))?;
        }
        let rays = finished_windows(&folder)?.map(|window| {
            let window = window?;
            anyhow::Ok(rows(&window, window.samples.iter().copied()).collect())
        });
        let plan = SplitPlan::default();
        let collected = Collected::write(rays, &plan, &out, self.replace)?;
        println!("{collected}\n{missing}\nwritten to {}", out.display());
        Ok(())
    }
}

/// The counts of rays that the collected database lacks.
fn missing(tally: &Tally) -> String {
    let failures: Vec<_> = tally
        .failures
        .iter()
        .map(|(kind, count)| format!("{count} {kind}"))
        .collect();
    let reasons = match failures.as_slice() {
        [] => String::new(),
        failures => format!(" (last failures: {})", failures.join(", ")),
    };
    format!(
        "missing: {} rays not solved yet, {} to retry, {} failed, {} with only part of their \
         samples{reasons}",
        tally.open, tally.retry, tally.failed, tally.partial
    )
}
