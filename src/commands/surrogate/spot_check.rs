//! `kirigami surrogate spot-check`: errors of weights against finite elements inside their training domain.

use crate::commands::solve_args::{SolveArgs, task_error};
use crate::commands::surrogate::errors::StateErrors;
use crate::commands::surrogate::trained_material;
use crate::ui::count::count;
use crate::ui::run_folder;
use anyhow::{Result, ensure};
use clap::Args;
use dataset::{Database, SplitPlan};
use mesher::Tier;
use std::path::PathBuf;
use surrogate::Surrogate;
use train::ErrorInterval;
use verification::{judging_tier, random_paths, spot_check};

/// States on a ray: more need fewer solves but cover fewer hinges.
const STATES_PER_RAY: usize = 4;
/// Minimum number of rays of a database, which is split in three parts.
const MIN_RAYS: usize = 3;

/// Measure the errors of weights at states drawn uniformly inside their training domain
///
/// The states lie on no training ray. Solves them by finite elements and writes them as a database, which
/// must not be used for training, so that `surrogate test` can test other weights on it. Prints the
/// distribution of the errors, their 95 % intervals over other rays, and the worst states. Example:
/// kirigami surrogate spot-check runs/weights/surrogate.safetensors --count 400 --tier default
#[derive(Args)]
pub struct SpotCheckCommand {
    /// Weights (safetensors with their card)
    #[arg(value_name = "WEIGHTS")]
    weights: PathBuf,
    /// Number of states, four on a ray
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = count::<usize>)]
    count: usize,
    /// Seed of the random states
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    seed: u64,
    /// Sheet material that the weights were trained on (TOML)
    #[arg(
        long,
        value_name = "FILE",
        default_value = "configs/materials/pet-0.5mm.toml"
    )]
    material: PathBuf,
    /// Mesh tier of the windows [default: that of the weights' database, or the finer tier that the
    /// database was corrected to]
    #[arg(long, value_name = "TIER")]
    tier: Option<Tier>,
    /// Folder for the database and the solutions
    #[arg(long, value_name = "FOLDER", default_value = "runs/spot-check")]
    out: PathBuf,
    #[command(flatten)]
    solve: SolveArgs,
}

impl SpotCheckCommand {
    pub fn run(&self) -> Result<()> {
        ensure!(self.count > 0, "--count must be at least 1");
        let surrogate = Surrogate::load(&self.weights)?;
        let material = trained_material(&surrogate, &self.weights, &self.material)?;
        let tier = judging_tier(self.tier, &surrogate)?;
        let paths = random_paths((&surrogate).into(), self.count, STATES_PER_RAY, self.seed);
        ensure!(
            paths.len() >= MIN_RAYS,
            "{} rays are too few for a database: increase --count",
            paths.len()
        );
        let _held = run_folder::hold(&self.out)?;
        let windows = self.solve.service(&self.out)?;
        let check = spot_check(&windows, &paths, &material, tier).map_err(task_error)?;
        let intervals = ErrorInterval::of(&surrogate, &check.rows);
        for unsolved in &check.unsolved {
            println!("not solved: {unsolved}");
        }
        ensure!(
            !check.rows.is_empty(),
            "no state was solved; see {}",
            self.out.display()
        );
        let database = Database::collect(check.rows, &SplitPlan::default())?;
        let path = self.out.join("spot-check.parquet");
        database.write(&path, true)?;
        println!(
            "{} states of {} rays on tier {tier}; {} states on rays that the solver did not follow to their end",
            database.rows().len(),
            paths.len(),
            check.unknown_states
        );
        if let Some([w, forces]) = intervals {
            println!("all states: W {w}; forces {forces}");
        }
        println!("{}", StateErrors::new(&surrogate, database.rows()));
        println!("written to {}", path.display());
        Ok(())
    }
}
