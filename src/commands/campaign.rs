//! `kirigami campaign`: plan, run, monitor and collect a campaign of window solves.

mod campaign_args;
mod check;
mod collect;
mod extend;
mod plan;
mod restore;
mod retry;
mod run;
mod status;
mod submit;

pub use collect::CollectCommand;
pub(crate) use run::RayProgress;
pub use run::RunCommand;

use anyhow::Result;
use clap::{Args, Subcommand};

/// Regenerate the hinge database: a campaign of window solves
///
/// A campaign is a TOML file (see configs/campaigns) and a folder of jobs. It can be stopped and
/// run again at any time; finished jobs are not solved again.
#[derive(Args)]
pub struct CampaignCommand {
    #[command(subcommand)]
    action: Action,
}

#[derive(Subcommand)]
enum Action {
    Plan(plan::PlanCommand),
    Run(RunCommand),
    Submit(submit::SubmitCommand),
    Status(status::StatusCommand),
    Retry(retry::RetryCommand),
    Check(check::CheckCommand),
    Collect(CollectCommand),
    Restore(restore::RestoreCommand),
    Extend(extend::ExtendCommand),
}

impl CampaignCommand {
    pub(crate) fn run(&self) -> Result<()> {
        match &self.action {
            Action::Plan(command) => command.run(),
            Action::Run(command) => command.run(),
            Action::Submit(command) => command.run(),
            Action::Status(command) => command.run(),
            Action::Retry(command) => command.run(),
            Action::Check(command) => command.run(),
            Action::Collect(command) => command.run(),
            Action::Restore(command) => command.run(),
            Action::Extend(command) => command.run(),
        }
    }
}
