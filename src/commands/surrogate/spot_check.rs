//! `kirigami surrogate spot-check`: errors of weights against finite elements inside their training domain.

use crate::commands::solve_args::{SolveArgs, task_error};
use crate::commands::surrogate::errors::StateErrors;
use crate::commands::surrogate::trained_material;
use crate::ui::count::count;
use crate::ui::run_folder;
use crate::ui::with_unit::percent;
use anyhow::{Result, ensure};
use clap::Args;
use dataset::{Database, Gates, SplitPlan};
use mesher::Tier;
use std::path::PathBuf;
use surrogate::Surrogate;
use train::ErrorInterval;
use verification::{judging_tier, random_paths, spot_check};

/// States on a ray: more need fewer solves but cover fewer hinges.
const STATES_PER_RAY: usize = 4;
/// Rays before the first look at the intervals of --within.
const FIRST_RAYS: usize = 16;
/// Minimum number of rays of a database, which is split in three parts.
const MIN_RAYS: usize = 3;

/// Measure the errors of weights at states drawn uniformly inside their training domain
///
/// The states lie on no training ray. Solves them by finite elements and writes them as a database, which
/// must not be used for training, so that `surrogate test` can test other weights on it. Prints the
/// distribution of the errors, their 95 % intervals over other rays, and the worst states. With --within rays are added until
/// these intervals are narrow enough. Example:
/// kirigami surrogate spot-check runs/weights/surrogate.safetensors --count 400 --within 33% --tier default
#[derive(Args)]
pub struct SpotCheckCommand {
    /// Weights (safetensors with their card)
    #[arg(value_name = "WEIGHTS")]
    weights: PathBuf,
    /// Number of states; with --within at most
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = count::<usize>)]
    count: usize,
    /// Stop as soon as the 95 % intervals of the errors of W and of the forces are within this part of them, such as 33%
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    within: Option<f64>,
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
        let mut rays = match self.within {
            Some(_) => FIRST_RAYS.min(paths.len()),
            None => paths.len(),
        };
        let (check, intervals) = loop {
            let check =
                spot_check(&windows, &paths[..rays], &material, tier).map_err(task_error)?;
            let intervals = ErrorInterval::of(&surrogate, &check.rows);
            let is_known = self.within.is_none_or(|within| {
                intervals.is_some_and(|found| {
                    let mut widths = found.iter().map(ErrorInterval::relative_half_width);
                    widths.all(|width| width <= within / 100.0)
                })
            });
            if is_known || rays == paths.len() {
                if !is_known {
                    println!("the intervals are wider than --within: increase --count");
                }
                break (check, intervals);
            }
            rays = (rays + rays.div_ceil(2)).min(paths.len());
        };
        for unsolved in &check.unsolved {
            println!("not solved: {unsolved}");
        }
        ensure!(
            !check.rows.is_empty(),
            "no state was solved; see {}",
            self.out.display()
        );
        let database = Database::collect(check.rows, &Gates::default(), &SplitPlan::default())?;
        let path = self.out.join("spot-check.parquet");
        database.write(&path, true)?;
        println!(
            "{} states of {} rays on tier {tier}; {} states on rays that the solver did not follow to their end",
            database.rows().len(),
            rays,
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
