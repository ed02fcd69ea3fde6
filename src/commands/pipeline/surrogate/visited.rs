//! `kirigami surrogate visited`

use crate::commands::pipeline::solve_args::SolveArgs;
use anyhow::{Context, Result, ensure};
use app::{chosen::Chosen, run_folder, solves::task_error, state_errors::print_errors};
use clap::Args;
use dataset::{Database, SplitPlan};
use scene::Scene;
use std::path::PathBuf;
use verification::{spot_check, verification_tier, visited_paths};

/// Print the errors of weights where designed sheets go: hinges solved along their paths
///
/// Twelve hinges of the runs, with five states each, are solved on the mesh of the spot check of
/// their weights: up to two minutes a hinge on one core. The errors are relative to the forces that
/// these hinges have, which are smaller than the forces at random states. Writes the states to
/// visited.parquet, on which `surrogate test` tests other weights. Example: kirigami surrogate
/// visited runs/visited runs/cat runs/star
#[derive(Args)]
pub(crate) struct VisitedCommand {
    /// Folder for the states and the solutions
    #[arg(value_name = "FOLDER")]
    out: PathBuf,
    /// Folders of runs, or scenes, with the same weights and thickness
    #[arg(value_name = "RUN", required = true)]
    runs: Vec<PathBuf>,
}

impl VisitedCommand {
    pub(super) fn run(&self) -> Result<()> {
        let mut runs = Vec::new();
        for run in &self.runs {
            let (scene, design, _) = Chosen { scene: run, design: None }.read()?;
            runs.push((scene.problem()?.deploy(&design)?, scene));
        }
        let first = &runs[0].1;
        let weights = first.surrogate().context("the first scene reads no weights")?;
        let solved = |scene: &Scene| {
            (scene.surrogate().map(|weights| weights.hash()), scene.material.thickness)
        };
        for ((_, scene), run) in runs.iter().zip(&self.runs) {
            ensure!(
                solved(scene) == solved(first),
                "{} has other weights or another thickness",
                run.display()
            );
        }
        let of_check = weights.card().spot_check.as_ref();
        let of_check = of_check.and_then(|check| check.tier.as_ref()?.parse().ok());
        let tier = verification_tier(of_check, weights)?;
        let _held = run_folder::hold(&self.out)?;
        let service = SolveArgs::default().solves()?.service(&self.out)?;
        let sheets: Vec<_> = runs.iter().map(|(deployed, _)| deployed).collect();
        let paths = visited_paths(&sheets)?;
        let check = spot_check(&service, &paths, &first.material, tier).map_err(task_error)?;
        for unsolved in &check.unsolved {
            println!("not solved: {unsolved}");
        }
        let visited = Database::collect(check.rays, &SplitPlan::TEST)?;
        visited.write(&self.out.join("visited.parquet"), true)?;
        print_errors(weights, &visited);
        Ok(())
    }
}
