//! `kirigami campaign submit`

use super::campaign_args::CampaignArgs;
use crate::{
    commands::solve_args::FeSolver,
    ui::count::{count, jobs},
};
use anyhow::Result;
use app::progress::duration;
use clap::Args;
use fe_driver::{ArrayTasks, slurm_folder, submit_array};
use std::num::NonZeroUsize;

/// Solve a campaign on a cluster: submit it to Slurm as an array of jobs
///
/// Each task of the array runs one shard. It stops before its time limit and is queued again until
/// its rays are solved. A further job collects the database when all tasks have ended. The folder
/// of the campaign must be on a file system that all nodes share. Submit again after tasks were
/// cancelled: solved rays are not solved again. Partition and account are read from Slurm's own
/// variables (SBATCH_PARTITION, SBATCH_ACCOUNT). Example: kirigami campaign submit
/// configs/campaigns/pet-0.5mm.toml --shards 32 --time 240
#[derive(Args)]
pub(crate) struct SubmitCommand {
    #[command(flatten)]
    campaign: CampaignArgs,
    /// Number of tasks, at most one a ray; each solves every N-th ray
    #[arg(long, value_name = "N", value_parser = count::<NonZeroUsize>)]
    shards: NonZeroUsize,
    /// Time limit of a task (minutes)
    #[arg(long, value_name = "MINUTES", value_parser = clap::value_parser!(u64).range(1..=525_600))]
    time: u64,
    /// Number of solves in parallel in each task, and of its processors
    #[arg(long, value_name = "N", default_value = "1", value_parser = jobs::<NonZeroUsize>)]
    jobs: NonZeroUsize,
}

impl SubmitCommand {
    pub(super) fn run(&self) -> Result<()> {
        let (campaign, folder) = (self.campaign.load()?, self.campaign.folder());
        // Further tasks would have no ray.
        let count = self.shards.get().min(campaign.size());
        let tasks = ArrayTasks { count, cores: self.jobs.get(), minutes: self.time };
        let versions = FeSolver::find()?.versions();
        let plan = fe_driver::plan(&campaign, &folder, &versions)?;
        let rays = plan.tally.to_run();
        if rays == 0 {
            println!("nothing is left to solve: run `kirigami campaign collect`");
            return Ok(());
        }
        fe_driver::prepare(&campaign, &folder, &versions)?;
        let submission = submit_array(&self.campaign.campaign, &folder, tasks)?;
        let processors = count * tasks.cores;
        println!(
            "{rays} rays to solve with {versions}, about {} on each of {processors} processors\n\
             array {} with {count} tasks; job {} then collects the database\n\
             `kirigami campaign status` shows both; logs are in {}",
            duration(plan.seconds / processors as f64),
            submission.array,
            submission.collect.unwrap_or_default(),
            slurm_folder(&folder).display()
        );
        Ok(())
    }
}
