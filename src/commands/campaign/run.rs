//! `kirigami campaign run`

use crate::commands::campaign::campaign_args::{CampaignArgs, print_tally};
use crate::ui::exit::Unfinished;
use crate::ui::interrupt;
use crate::ui::processors;
use crate::ui::progress::Progress;
use anyhow::{Result, bail, ensure};
use clap::Args;
use fe_driver::{Campaign, RunOptions, Shard, Tally, Tools};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Solve all rays that are not solved yet
///
/// Exit code 0 if nothing is left to solve, 75 if stopped before that by Ctrl-C or by --time-limit:
/// run the same command again to continue.
#[derive(Args)]
pub struct RunCommand {
    #[command(flatten)]
    campaign: CampaignArgs,
    /// Number of solves in parallel [default: one per processor]
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
    /// Solve only part I of N; parts of the same folder can run at the same time
    #[arg(long, value_name = "I/N", default_value_t = Shard::WHOLE)]
    shard: Shard,
    /// Start no solve after this time (minutes); running solves are finished
    #[arg(long, value_name = "MINUTES", value_parser = minutes)]
    time_limit: Option<Duration>,
}

impl RunCommand {
    pub(crate) fn new(campaign: PathBuf, folder: PathBuf) -> Self {
        let campaign = CampaignArgs {
            campaign,
            folder: Some(folder),
        };
        Self {
            campaign,
            jobs: None,
            shard: Shard::WHOLE,
            time_limit: None,
        }
    }

    pub(crate) fn run(&self) -> Result<()> {
        let folder = self.campaign.folder();
        let options = RunOptions {
            shard: self.shard,
            workers: self.jobs.map_or_else(processors, NonZeroUsize::get),
            time_limit: self.time_limit,
        };
        let tally = solve_rays(&self.campaign.load()?, &folder, &options)?;
        print_tally(&tally);
        refuse_unfinished(&tally, &folder)
    }
}

/// Solves the open rays of a campaign, with progress.
pub fn solve_rays(campaign: &Campaign, folder: &Path, options: &RunOptions) -> Result<Tally> {
    let tools = Tools::find()?;
    let stop = interrupt::stop_flag()?;
    let bar = Progress::new(campaign.size(), "rays");
    let end = fe_driver::run(campaign, folder, &tools, options, stop, &mut |now| {
        let tally = &now.tally;
        let message = format!("{} samples, {} failed", tally.rows, tally.failed);
        bar.set_total(tally.closed() + tally.to_run());
        bar.show(tally.closed(), now.seconds_left, &message);
    })?;
    bar.finish();
    Ok(end.tally)
}

/// An error if rays are left to solve, or if every ray failed.
pub fn refuse_unfinished(tally: &Tally, folder: &Path) -> Result<()> {
    if tally.to_run() > 0 {
        let (left, what) = (tally.to_run(), "rays");
        bail!(Unfinished::new(left, what));
    }
    ensure!(
        tally.failed == 0 || tally.complete + tally.partial > 0,
        "every ray failed: read a job's log in {}, fix the cause, then run `kirigami campaign retry`",
        folder.join("jobs").display()
    );
    Ok(())
}

fn minutes(text: &str) -> Result<Duration, String> {
    let minutes: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    Duration::try_from_secs_f64(60.0 * minutes).map_err(|error| error.to_string())
}
