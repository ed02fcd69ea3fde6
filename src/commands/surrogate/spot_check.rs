//! `kirigami surrogate spot-check`: errors of weights against finite elements inside their training domain.

use crate::commands::inspect::judged_design::DESIGN_TO_JUDGE;
use crate::commands::inspect::scene_args::Inspected;
use crate::commands::solve_args::{SolveArgs, task_error};
use crate::commands::surrogate::errors::StateErrors;
use crate::commands::surrogate::trained_material;
use crate::ui::count::count;
use crate::ui::run_folder;
use crate::ui::with_unit::percent;
use anyhow::{Context, Result, ensure};
use clap::Args;
use dataset::{Database, SplitPlan};
use mesher::Tier;
use std::path::PathBuf;
use surrogate::Surrogate;
use train::ErrorInterval;
use verification::{SpotPath, judging_tier, random_paths, recorded_paths, spot_check};

/// Rays before the first look at the intervals of --within.
const FIRST_RAYS: usize = 16;
/// Minimum number of rays of a database, which is split in three parts.
const MIN_RAYS: usize = 3;

/// Measure the errors of weights at states drawn uniformly inside their training domain
///
/// The states lie on no training ray. Solves them by finite elements and writes them as a database, which
/// must not be used for training, so that `surrogate test` can test other weights on it. Prints the
/// distribution of the errors, their 95 % intervals over other rays, and the worst states. With --within rays are added until
/// these intervals are narrow enough. With --scene the states are those of the hinges of a design
/// along their paths instead. Example:
/// kirigami surrogate spot-check runs/weights/surrogate.safetensors --count 400 --within 33% --tier default
#[derive(Args)]
pub struct SpotCheckCommand {
    /// Weights (safetensors with their card)
    #[arg(value_name = "WEIGHTS")]
    weights: PathBuf,
    /// Number of states; with --within at most
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = count::<usize>)]
    count: usize,
    /// States per ray: more states per ray need fewer solves but cover fewer hinges
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u16).range(1..=100))]
    states_per_ray: u16,
    /// Stop as soon as the 95 % intervals of the errors of W and of the forces are within this part of them, such as 33%
    #[arg(long, value_name = "PERCENT", value_parser = percent, conflicts_with = "scene")]
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
    #[command(flatten)]
    paths: PathArgs,
    /// Folder for the database and the solutions
    #[arg(long, value_name = "FOLDER", default_value = "runs/spot-check")]
    out: PathBuf,
    #[command(flatten)]
    solve: SolveArgs,
}

/// The hinges of a design.
#[derive(Args)]
struct PathArgs {
    /// Use the hinges of this scene (TOML) along their paths instead, with at least COUNT of their states
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    #[arg(long, value_name = "FILE", requires = "scene", help = DESIGN_TO_JUDGE)]
    design: Option<PathBuf>,
}

impl SpotCheckCommand {
    pub fn run(&self) -> Result<()> {
        ensure!(self.count > 0, "--count must be at least 1");
        let surrogate = Surrogate::load(&self.weights)?;
        let material = trained_material(&surrogate, &self.weights, &self.material)?;
        let tier = judging_tier(self.tier, &surrogate)?;
        let paths = match &self.paths.scene {
            Some(_) => self.on_paths()?,
            None => self.random(&surrogate),
        };
        ensure!(
            paths.len() >= MIN_RAYS,
            "{} rays are too few for a database: increase --count or decrease --states-per-ray",
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
        let database = Database::collect(check.rows, &SplitPlan::default())?;
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

    fn random(&self, surrogate: &Surrogate) -> Vec<SpotPath> {
        let each = usize::from(self.states_per_ray);
        random_paths(surrogate.into(), self.count, each, self.seed)
    }

    fn on_paths(&self) -> Result<Vec<SpotPath>> {
        let PathArgs { scene, design } = &self.paths;
        let scene = scene.clone().context("no scene")?;
        let (scene, design, name) = Inspected::new(scene, design.clone()).read_judged()?;
        println!("{name}");
        let recorded = recorded_paths(&scene, &design)?;
        let states = recorded.first().map_or(1, |path| path.states.len());
        let wanted = (self.count.div_ceil(states).max(MIN_RAYS)).min(recorded.len());
        (0..wanted)
            .map(|i| {
                let path = recorded[i * recorded.len() / wanted].scaled(scene.scale().recip());
                let count = path.states.len();
                Ok(SpotPath {
                    hinge: path.hinge_path()?,
                    fractions: (1..=count).map(|k| k as f64 / count as f64).collect(),
                })
            })
            .collect()
    }
}
