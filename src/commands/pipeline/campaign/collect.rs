//! `kirigami campaign collect`

use super::campaign_args::{CampaignArgs, DATABASE, SPOT_CHECK};
use anyhow::{Context, Result, ensure};
use app::output_file;
use clap::Args;
use dataset::{Collected, Database, SplitPlan};
use fe_driver::{JobPart, Solved, SolvedRay, Tally, finished_windows};
use std::path::PathBuf;
use verification::SpotStates;

/// Collect the samples of all finished jobs: the database hinges.parquet, and spot-check.parquet,
/// on which weights are tested
///
/// Rays on the finer mesh are in the database too; `train` corrects the others by them. Example:
/// kirigami campaign collect configs/campaigns/demo.toml
#[derive(Args)]
pub(crate) struct CollectCommand {
    #[command(flatten)]
    campaign: CampaignArgs,
    /// Parquet file to write; the spot check is written next to it [default: hinges.parquet in the
    /// folder of the jobs]
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
        let campaign = self.campaign.load()?;
        let parts = fe_driver::known_parts(&campaign, &folder)?;
        let tally = fe_driver::status(&folder)?.tally;
        let missing = missing(&tally);
        ensure!(
            tally.to_run() == 0 || self.partial,
            "{missing} in {}: run the campaign, or pass --partial to collect without them",
            folder.display()
        );
        let out = self.out.clone().unwrap_or_else(|| folder.join(DATABASE));
        let of_spot = out.with_file_name(SPOT_CHECK);
        if campaign.spot_rays > 0 && !self.replace {
            output_file::refuse_existing(&of_spot)?;
        }
        output_file::create_folder_of(&out)?;
        let is_ray = |window: &Solved| parts.get(&window.id) != Some(&JobPart::SpotCheck);
        let rays = finished_windows(&folder)?
            .filter(|window| window.as_ref().map_or(true, is_ray))
            .map(|window| {
                let window = window?;
                anyhow::Ok(SolvedRay::new(&window, window.samples.clone()))
            });
        let plan = SplitPlan::default();
        let collected = Collected::write(rays, &plan, &out, self.replace)?;
        println!("{collected}\n{missing}\nwritten to {}", out.display());
        if campaign.spot_rays > 0 {
            let check = SpotStates::collected(&campaign, &parts, &folder)?;
            let spot = Database::collect(check.rays, &plan);
            match spot.context("too few rays of the spot check are solved") {
                Err(error) if self.partial => println!("no spot check: {error:#}"),
                spot => {
                    let spot = spot?;
                    spot.write(&of_spot, self.replace)?;
                    println!(
                        "spot check: {} states of {} rays, {} states unknown, written to {}",
                        spot.manifest().rows,
                        spot.manifest().rays,
                        check.unknown_states,
                        of_spot.display()
                    );
                }
            }
        }
        Ok(())
    }
}

/// The counts of rays that the collected database lacks.
fn missing(tally: &Tally) -> String {
    let failures: Vec<_> =
        tally.failures.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
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
