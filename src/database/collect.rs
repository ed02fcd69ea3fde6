//! `kirigami database collect`

use super::CampaignArgs;
use super::rows::rows_of;
use anyhow::{Context, Result, bail};
use clap::Args;
use dataset::{Database, Gates, SplitPlan};
use fe_driver::{Tally, finished_jobs};
use std::path::PathBuf;

/// Gather the samples of all finished jobs into a Parquet file with its manifest
#[derive(Args)]
pub struct CollectCommand {
    #[command(flatten)]
    campaign: CampaignArgs,
    /// The Parquet file [default: hinges.parquet in the folder of the jobs]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Collect although jobs are left to run
    #[arg(long)]
    partial: bool,
    /// Replace an existing Parquet file
    #[arg(long)]
    replace: bool,
}

impl CollectCommand {
    pub fn new(campaign: PathBuf, folder: PathBuf, out: PathBuf) -> Self {
        let campaign = CampaignArgs {
            campaign,
            folder: Some(folder),
        };
        Self {
            campaign,
            out: Some(out),
            partial: false,
            replace: true,
        }
    }

    pub fn run(&self) -> Result<()> {
        let folder = self.campaign.folder();
        fe_driver::refuse_changed(&self.campaign.load()?, &folder)?;
        let tally = fe_driver::status(&folder)?.tally;
        let missing = missing(&tally);
        if tally.to_run() > 0 && !self.partial {
            bail!(
                "{missing} in {}: run the campaign, or collect with --partial",
                folder.display()
            );
        }
        let mut rows = Vec::new();
        for job in finished_jobs(&folder)? {
            rows.extend(rows_of(&job?));
        }
        let database = Database::collect(rows, &Gates::default(), &SplitPlan::default())?;
        let out = self
            .out
            .clone()
            .unwrap_or_else(|| folder.join("hinges.parquet"));
        if let Some(parent) = out.parent() {
            std::fs::create_dir_all(parent)
                .with_context(|| format!("cannot make the folder {}", parent.display()))?;
        }
        database.write(&out, self.replace)?;
        println!("{database}\n{missing}\nwritten to {}", out.display());
        Ok(())
    }
}

/// What a database of the campaign does not hold.
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
        "missing: {} rays not solved yet, {} to retry, {} failed, {} with a part of their \
         samples{reasons}",
        tally.open, tally.retry, tally.failed, tally.partial
    )
}
