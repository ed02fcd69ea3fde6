//! `kirigami database`: plan, run, watch and collect a campaign of window solves.

use crate::interrupt;
use crate::progress::{self, duration};
use anyhow::{Context, Result, bail};
use clap::{Args, Subcommand};
use dataset::{Database, Gates, Row, SplitPlan};
use fe_driver::{Campaign, FinishedJob, Tally, ToolVersions, Tools, finished_jobs};
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
    Plan(PlanCommand),
    Run(RunCommand),
    Status(StatusCommand),
    Collect(CollectCommand),
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

/// Say what a run would do, and how long it would take
#[derive(Args)]
struct PlanCommand {
    #[command(flatten)]
    campaign: CampaignArgs,
}

/// Solve what is not solved yet
#[derive(Args)]
pub struct RunCommand {
    #[command(flatten)]
    campaign: CampaignArgs,
    /// Solves at a time [default: one for each processor]
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
}

/// Show how the jobs of a campaign stand
#[derive(Args)]
struct StatusCommand {
    #[command(flatten)]
    campaign: CampaignArgs,
}

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

impl DatabaseCommand {
    pub fn run(&self) -> Result<()> {
        match &self.action {
            Action::Plan(command) => command.run(),
            Action::Run(command) => command.run(),
            Action::Status(command) => command.run(),
            Action::Collect(command) => command.run(),
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

impl PlanCommand {
    fn run(&self) -> Result<()> {
        let folder = self.campaign.folder();
        let versions = ToolVersions::of(&Tools::find()?);
        let plan = fe_driver::plan(&self.campaign.load()?, &folder, &versions)?;
        print_tally(&plan.tally);
        for (changed, count) in &plan.stale {
            println!(
                "{count} jobs in {} are stale: {changed} changed",
                folder.display()
            );
        }
        println!(
            "a run would solve {} rays in about {} on {} processors",
            plan.tally.to_run(),
            duration(plan.seconds / processors() as f64),
            processors()
        );
        Ok(())
    }
}

impl RunCommand {
    pub fn new(campaign: PathBuf, folder: PathBuf) -> Self {
        let campaign = CampaignArgs {
            campaign,
            folder: Some(folder),
        };
        Self {
            campaign,
            jobs: None,
        }
    }

    pub fn run(&self) -> Result<()> {
        let (campaign, folder) = (self.campaign.load()?, self.campaign.folder());
        let tools = Tools::find()?;
        let stop = interrupt::stop_flag()?;
        let bar = progress::bar(campaign.count, "rays");
        let workers = self.jobs.unwrap_or_else(processors);
        let end = fe_driver::run(&campaign, &folder, &tools, workers, stop, &mut |now| {
            let tally = &now.tally;
            let message = format!("{} samples, {} failed", tally.rows, tally.failed);
            progress::show(&bar, tally.closed(), now.seconds_left, &message);
        })?;
        bar.finish_and_clear();
        print_tally(&end.tally);
        if end.tally.to_run() > 0 {
            bail!(
                "stopped with {} rays left; run again to go on",
                end.tally.to_run()
            );
        }
        Ok(())
    }
}

impl StatusCommand {
    fn run(&self) -> Result<()> {
        let status = fe_driver::status(&self.campaign.folder())?;
        print_tally(&status.tally);
        if let Some(pace) = status.tally.jobs_per_worker_hour() {
            println!("{pace:.0} rays an hour of one processor");
        }
        Ok(())
    }
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
        let left = fe_driver::status(&folder)?.tally.to_run();
        if left > 0 && !self.partial {
            bail!(
                "{left} rays in {} are not solved yet: run the campaign, or collect with --partial",
                folder.display()
            );
        }
        let mut rows = Vec::new();
        for job in finished_jobs(&folder)? {
            rows.extend(database_rows(job?));
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
        println!("{database}\nwritten to {}", out.display());
        Ok(())
    }
}

/// The rows of the database that one job gives.
fn database_rows(job: FinishedJob) -> Vec<Row> {
    let row = |sample| Row {
        job: job.id.clone(),
        design: job.ray.design,
        sample,
        partial: job.partial,
        material: job.material.clone(),
        tier: job.tier.to_string(),
        gmsh: job.tools.gmsh.clone(),
        ccx: job.tools.ccx.clone(),
        cpu_s: job.cpu_seconds,
    };
    job.samples.iter().copied().map(row).collect()
}

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
    for (reason, count) in &tally.failures {
        println!("  {count} ended early: {reason}");
    }
}

fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
