//! `kirigami database`: plan, run, watch and collect a campaign of window solves.

mod collect;
mod extend;
mod plan;
mod restore;
mod retry;
mod rows;
mod run;
mod status;

pub use collect::CollectCommand;
pub use run::{RunCommand, Unfinished};

use crate::progress::duration;
use crate::table::table;
use anyhow::Result;
use clap::{Args, Subcommand};
use fe_driver::{Campaign, Tally};
use std::path::{Path, PathBuf};

/// Regenerate the hinge database: a campaign of window solves
///
/// A campaign is a TOML file (see configs/campaigns) and a folder of jobs. It can be stopped and
/// run again at any time: nothing finished is solved twice.
#[derive(Args)]
pub struct DatabaseCommand {
    #[command(subcommand)]
    action: Action,
}

#[derive(Subcommand)]
enum Action {
    Plan(plan::PlanCommand),
    Run(RunCommand),
    Status(status::StatusCommand),
    Retry(retry::RetryCommand),
    Collect(CollectCommand),
    Restore(restore::RestoreCommand),
    Extend(extend::ExtendCommand),
}

/// A campaign and the folder of its jobs.
#[derive(Args)]
struct CampaignArgs {
    /// Campaign (TOML), for example configs/campaigns/demo.toml
    #[arg(value_name = "CAMPAIGN")]
    campaign: PathBuf,
    /// Folder of the jobs [default: runs/<name of the campaign file>]
    #[arg(long, value_name = "FOLDER")]
    folder: Option<PathBuf>,
}

impl DatabaseCommand {
    pub fn run(&self) -> Result<()> {
        match &self.action {
            Action::Plan(command) => command.run(),
            Action::Run(command) => command.run(),
            Action::Status(command) => command.run(),
            Action::Retry(command) => command.run(),
            Action::Collect(command) => command.run(),
            Action::Restore(command) => command.run(),
            Action::Extend(command) => command.run(),
        }
    }
}

impl CampaignArgs {
    fn load(&self) -> Result<Campaign> {
        Ok(Campaign::load(&self.campaign)?)
    }

    fn folder(&self) -> PathBuf {
        self.folder.clone().unwrap_or_else(|| {
            Path::new("runs").join(self.campaign.file_stem().unwrap_or_default())
        })
    }
}

/// Counts, and why jobs failed.
fn print_tally(tally: &Tally) {
    println!(
        "{} rays complete, {} partial, {} failed, {} to retry, {} open; {} samples; {} of solving",
        tally.complete,
        tally.partial,
        tally.failed,
        tally.retry,
        tally.open,
        tally.rows,
        duration(tally.cpu_seconds)
    );
    if !tally.failures.is_empty() {
        let mut failures = table(["last failure", "rays"]);
        for (reason, count) in &tally.failures {
            failures.add_row([reason.to_string(), count.to_string()]);
        }
        println!("{failures}");
    }
}

pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
