//! `kirigami campaign submit`

use crate::commands::campaign::campaign_args::CampaignArgs;
use crate::commands::solve_args::FeSolver;
use crate::ui::count::{count, jobs};
use crate::ui::progress::duration;
use anyhow::{Context, Result};
use clap::Args;
use fe_driver::{ArrayScript, SLURM, slurm_folder, submit_array};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf, absolute};
use support::text_file;

/// Solve a campaign on a cluster: submit it to Slurm as an array of jobs
///
/// Each task of the array runs one shard. It stops before its time limit and is queued again until
/// its rays are solved. A further job collects the database when all tasks have ended. The folder
/// of the campaign must be on a file system that all nodes share. Submit again after tasks were
/// cancelled: solved rays are not solved again. Example: kirigami campaign submit
/// configs/campaigns/pet-0.5mm.toml --shards 32 --time 240
#[derive(Args)]
pub struct SubmitCommand {
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
    /// Template of the script [default: the template in configs/cluster/slurm.sh]
    #[arg(long, value_name = "FILE")]
    template: Option<PathBuf>,
    /// Print the script and submit nothing
    #[arg(long)]
    dry_run: bool,
}

impl SubmitCommand {
    pub fn run(&self) -> Result<()> {
        let (campaign, folder) = (self.campaign.load()?, self.campaign.folder());
        // Further tasks would have no ray.
        let tasks = self.shards.get().min(campaign.size());
        let script = self.script(&folder, tasks)?;
        if self.dry_run {
            print!("{script}");
            return Ok(());
        }
        let versions = FeSolver::find()?.versions();
        let plan = fe_driver::plan(&campaign, &folder, &versions)?;
        let rays = plan.tally.to_run();
        if rays == 0 {
            println!("nothing is left to solve: run `kirigami campaign collect`");
            return Ok(());
        }
        fe_driver::prepare(&campaign, &folder, &versions)?;
        let submission = submit_array(&folder, &script, tasks)?;
        println!(
            "{rays} rays to solve with {versions}, about {} on each of {} processors\n\
             array {} with {tasks} tasks; job {} then collects the database\n\
             `kirigami campaign status` shows both; logs are in {}",
            duration(plan.seconds / (tasks * self.jobs.get()) as f64),
            tasks * self.jobs.get(),
            submission.array,
            submission.collect.map_or(String::new(), |job| job.to_string()),
            slurm_folder(&folder).display()
        );
        Ok(())
    }

    fn script(&self, folder: &Path, tasks: usize) -> Result<String> {
        let template = match &self.template {
            None => SLURM.to_owned(),
            Some(path) => {
                text_file::read(path).with_context(|| format!("cannot read {}", path.display()))?
            }
        };
        let script = ArrayScript {
            program: std::env::current_exe().context("cannot find this program's own path")?,
            here: std::env::current_dir().context("cannot find the current folder")?,
            campaign: self.campaign.campaign.clone(),
            folder: folder.to_owned(),
            logs: absolute(slurm_folder(folder))?,
            shards: tasks,
            cores: self.jobs.get(),
            minutes: self.time,
        };
        let named = || match &self.template {
            None => "the shipped template".to_owned(),
            Some(path) => path.display().to_string(),
        };
        script.fill(&template).with_context(named)
    }
}
