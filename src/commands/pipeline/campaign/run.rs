//! `kirigami campaign run`

use super::campaign_args::{CampaignArgs, print_tally};
use crate::commands::pipeline::solve_args::SolveArgs;
use anyhow::{Result, bail, ensure};
use app::{
    failure::Unfinished,
    solves::{RayProgress, Solves},
};
use clap::Args;
use fe_driver::{CalculiX, RunOptions, Shard, Tally};
use std::{path::Path, time::Duration};
use verification::every_ray_failed;

/// Solve all rays that are not solved yet
///
/// Exit code 0 if nothing is left to solve, 75 if stopped before that by Ctrl-C or by --time-limit:
/// run the same command again to continue.
#[derive(Args)]
pub(crate) struct RunCommand {
    #[command(flatten)]
    campaign: CampaignArgs,
    #[command(flatten)]
    solve: SolveArgs,
    /// Solve only part I of N; parts of the same folder can run at the same time
    #[arg(long, value_name = "I/N", default_value_t = Shard::WHOLE)]
    shard: Shard,
    /// Start no solve after this time (minutes); running solves are finished
    #[arg(long, value_name = "MINUTES", value_parser = minutes)]
    time_limit: Option<Duration>,
    /// Solve rays that failed or ended early again, after a change that is not a setting of the
    /// job: more memory, a longer time limit per solve, a repaired solver
    #[arg(long)]
    retry: bool,
}

impl RunCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let folder = self.campaign.folder();
        let Solves { workers, stop } = self.solve.solves()?;
        let options = RunOptions {
            shard: self.shard,
            workers,
            time_limit: self.time_limit,
            retry: self.retry,
        };
        let (campaign, solver) = (self.campaign.load()?, CalculiX::find()?);
        let bar = RayProgress::new(campaign.size());
        let show = &mut |now: &fe_driver::CampaignProgress| bar.show(now);
        let ended = fe_driver::run(&campaign, &folder, &solver, &options, stop, show)?;
        bar.0.finish();
        let tally = ended.tally;
        print_tally(&tally);
        for (job, reason) in &ended.disturbed {
            println!("ray {job} stays open, the machine ended its attempts: {reason}");
        }
        refuse_unfinished(&tally, &folder)
    }
}

/// An error if rays are left to solve, or if every ray failed.
fn refuse_unfinished(tally: &Tally, folder: &Path) -> Result<()> {
    if tally.to_run() > 0 {
        bail!(Unfinished { left: tally.to_run(), what: "rays" });
    }
    ensure!(tally.failed == 0 || tally.complete + tally.partial > 0, every_ray_failed(folder));
    Ok(())
}

fn minutes(text: &str) -> Result<Duration, String> {
    let minutes: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    Duration::try_from_secs_f64(60.0 * minutes).map_err(|error| error.to_string())
}
