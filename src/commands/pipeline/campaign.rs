//! `kirigami campaign`: plan, run, monitor and collect a campaign of window solves.

mod campaign_args;
mod collect;
mod plan;
mod restore;
mod run;
mod status;

pub(crate) use campaign_args::{DATABASE, SPOT_CHECK};

subcommands! {
    /// Regenerate the hinge database: a campaign of window solves
    ///
    /// A campaign is a TOML file (see configs/campaigns) and a folder of jobs. It can be stopped and
    /// run again at any time; finished jobs are not solved again.
    pub(crate) enum CampaignCommand {
        Plan(plan::PlanCommand),
        Run(run::RunCommand),
        Status(status::StatusCommand),
        Collect(collect::CollectCommand),
        Restore(restore::RestoreCommand),
    }
}
