//! `kirigami solve`: one window solved along one ray, printed as a table.

use crate::{commands::pipeline::window_args::WindowArgs, ui::interrupt};
use anyhow::{Error, Result, bail};
use app::{
    failure::Unfinished,
    input_file,
    progress::watched,
    run_folder,
    solves::{LIMIT, ray_table},
};
use clap::Args;
use fe_driver::{CalculiX, Cause, Ray, Solver, WindowProblem, WindowSolve, reached};
use hinge::{HingeDeformation, SheetMaterial};
use mesher::Tier;
use serde_json::json;
use std::{path::PathBuf, time::Duration};

/// Solve one hinge window by finite elements and print its ray
///
/// Panel A is fixed. Panel B is driven from the undeformed state straight to the given deformation.
/// Every converged increment is one row. Writes window.vtu for ParaView and meshio: displacements,
/// plastic strain and stress of the last increment. Example, the paper's hinge folded to 45
/// degrees: kirigami solve --theta-deg 45 --tier tiny
#[derive(Args)]
#[command(allow_negative_numbers = true)]
pub(crate) struct SolveCommand {
    #[command(flatten)]
    window: WindowArgs,
    /// Relative rotation at the end of the ray (degrees); positive opens the main cut
    #[arg(long, value_name = "DEG", default_value_t = 60.0)]
    theta_deg: f64,
    /// Axial opening at the end of the ray, divided by the ligament width; negative in compression
    #[arg(long, value_name = "RATIO", default_value_t = 0.0)]
    eta_a: f64,
    /// Shear at the end of the ray, divided by the ligament width
    #[arg(long, value_name = "RATIO", default_value_t = 0.0)]
    eta_s: f64,
    /// Sheet material (TOML)
    #[arg(long, value_name = "FILE", default_value = "configs/materials/pet-0.5mm.toml")]
    material: PathBuf,
    /// Mesh tier: tiny, small, default, fine, reference or paper; for plates plate-tiny, plate or
    /// plate-reference
    #[arg(long, value_name = "TIER", default_value_t = Tier::Default)]
    tier: Tier,
    /// Time limit of the solver (s); time in which the machine is suspended does not count
    #[arg(long, value_name = "S", default_value_t = LIMIT.as_secs(), value_parser = clap::value_parser!(u64).range(1..=86_400))]
    time_limit_s: u64,
    /// Folder for the mesh, the input deck, the log and the solver's output
    #[arg(long, value_name = "FOLDER", default_value = "runs/solve")]
    out: PathBuf,
    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

impl SolveCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let design = self.window.design()?;
        let theta = self.theta_deg.to_radians();
        let end = HingeDeformation::from_eta(self.eta_a, self.eta_s, theta, design.w_lig);
        let hinge = Ray { design, end }.driven(self.tier.regime());
        input_file::require(&self.material, "--material")?;
        let material = SheetMaterial::load(&self.material)?;
        let _held = run_folder::hold(&self.out)?;
        let stop = interrupt::stop_flag()?;
        let solver = CalculiX { print_all: true, ..CalculiX::find()? };
        let problem = WindowProblem::new(hinge, &material, self.tier);
        let solve = WindowSolve::new(problem, &solver.versions());
        let limit = Duration::from_secs(self.time_limit_s);
        let solution =
            watched(1, || reached(&self.out), || solver.attempt(&solve, &self.out, limit, stop))
                .map_err(|error| match error.cause == Cause::Stop {
                    true => Unfinished { left: 1, what: "ray" }.into(),
                    false => Error::from(error),
                })?;
        if let Some(grid) = solver.fields(&solve, &self.out)? {
            run_folder::write(&self.out, "window.vtu", &grid.to_vtu())?;
        }
        if self.json {
            let description = json!({
                "design": design,
                "path": solve.problem.hinge.path,
                "material": material,
                "tier": self.tier,
                "samples": solution.samples,
                "stopped": solution.stopped.as_ref().map(ToString::to_string),
                "cpu_seconds": solution.cpu_seconds,
                "wall_seconds": solution.wall_seconds,
                "iterations": solution.iterations,
            });
            println!("{description:#}");
        } else if !solution.samples.is_empty() {
            println!("{}", ray_table(&solution.samples));
            println!(
                "{} increments, {} iterations, {:.1} s; mesh, input deck and log in {}",
                solution.samples.len(),
                solution.iterations,
                solution.wall_seconds,
                self.out.display()
            );
        }
        match solution.stopped {
            None => Ok(()),
            Some(reason) => bail!("the solve stopped before the end of the ray: {reason}"),
        }
    }
}
