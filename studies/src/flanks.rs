//! `kirigami-studies flanks`: whether the flanks of cuts touch, where windows have no contact.
//!
//! Rays are drawn whose rigid panels would pass through each other in the plane at the hole. In the solved windows the panels tilt
//! out of it, which draws the flanks apart: how far is measured on the deformed meshes.

use crate::attempt::attempt;
use anyhow::{Result, ensure};
use clap::Args;
use design::analysis::flanks::gap_at_hole;
use fe_driver::{CalculiX, HingePath, WindowProblem, WindowSolve};
use hinge::SheetMaterial;
use kirigami::ui::progress::Progress;
use kirigami::ui::run_folder;
use mesher::Tier;
use std::path::PathBuf;
use std::time::Duration;
use support::table::{Cell, Table};
use surrogate::Surrogate;
use verification::random_paths;

/// Measure whether the flanks of cuts touch in windows whose rigid panels would overlap
///
/// Draws rays inside the training domain of the weights whose flanks overlap in the plane at their end, solves their windows, and
/// measures the least distance of the flanks on the deformed meshes. Writes flanks.md and flanks.csv. 20 minutes on one processor.
/// Example: kirigami-studies flanks --rays 4 --tier tiny
#[derive(Args)]
pub struct FlanksStudy {
    /// Weights whose domain the rays are drawn from
    #[arg(
        long,
        value_name = "FILE",
        default_value = "data/pet-0.5mm/medium.safetensors"
    )]
    weights: PathBuf,
    /// Sheet material of the weights (TOML)
    #[arg(
        long,
        value_name = "FILE",
        default_value = "configs/materials/pet-0.5mm.toml"
    )]
    material: PathBuf,
    /// Number of rays
    #[arg(long, value_name = "N", default_value_t = 40)]
    rays: usize,
    /// Mesh tier of the windows
    #[arg(long, value_name = "TIER", default_value_t = Tier::Default)]
    tier: Tier,
    /// Time limit of each solve (s)
    #[arg(long, value_name = "SECONDS", default_value_t = 3600)]
    time_limit_s: u64,
    /// Folder for the tables and the solutions
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-flanks")]
    out: PathBuf,
}

/// Number of rays from which those are taken whose flanks overlap.
const DRAWN: usize = 10_000;

/// A window, solved.
struct Row {
    hinge: HingePath,
    /// Fraction of the ray that was solved.
    lambda: f64,
    /// Least distance of the flanks at one height along the ray (mm); `None` if they are nowhere at one height.
    nearest: Option<f64>,
    /// Number of increments, and those in which flanks pass through each other.
    increments: usize,
    through: usize,
    /// Largest displacement out of the plane (mm).
    height: f64,
}

impl FlanksStudy {
    pub fn run(&self) -> Result<()> {
        let _held = run_folder::hold(&self.out)?;
        let material = SheetMaterial::load(&self.material)?;
        let overlapping = self.overlapping()?;
        let solver = CalculiX::find()?;
        let bar = Progress::new(overlapping.len(), "windows");
        let mut rows = Vec::new();
        for (i, hinge) in overlapping.into_iter().enumerate() {
            bar.show(i, None, "");
            let problem = WindowProblem::new(hinge, &material, self.tier);
            let solve = WindowSolve::new(problem, &solver.versions());
            rows.push(self.solved(&solver, &solve, i)?);
        }
        bar.finish();
        let table = table(material.thickness);
        run_folder::write(&self.out, "flanks.csv", &table.csv(&rows))?;
        let page = format!("{}\n{}", self.summary(&rows), table.markdown(&rows));
        run_folder::write(&self.out, "flanks.md", &page)?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }

    /// Rays inside the domain of the weights whose flanks overlap in the plane at their end.
    fn overlapping(&self) -> Result<Vec<HingePath>> {
        let weights = Surrogate::load(&self.weights)?;
        let drawn = random_paths((&weights).into(), DRAWN, 1, 0);
        let overlap = |hinge: &HingePath| gap_at_hole(&hinge.design, &hinge.path.at(1.0)) < 0.0;
        let mut found: Vec<HingePath> = drawn.into_iter().map(|path| path.hinge).collect();
        found.retain(overlap);
        found.truncate(self.rays);
        ensure!(
            !found.is_empty(),
            "no ray inside the domain has flanks that overlap"
        );
        Ok(found)
    }

    fn solved(&self, solver: &CalculiX, solve: &WindowSolve, number: usize) -> Result<Row> {
        let folder = self.out.join(format!("window-{number}"));
        let limit = Duration::from_secs(self.time_limit_s);
        let solution = attempt(solver, solve, &folder, limit)??;
        let gaps = solver.flank_gaps(solve, &folder)?;
        let last = solution.samples.last();
        Ok(Row {
            hinge: solve.problem.hinge.clone(),
            lambda: last.map_or(0.0, |sample| sample.lambda),
            nearest: gaps.iter().flatten().copied().reduce(f64::min),
            increments: gaps.len(),
            through: gaps.iter().flatten().filter(|gap| **gap < 0.0).count(),
            height: last.map_or(0.0, |sample| sample.uz_max),
        })
    }

    fn summary(&self, rows: &[Row]) -> String {
        let touching = rows.iter().filter(|row| row.through > 0).count();
        let increments: usize = rows.iter().map(|row| row.increments).sum();
        let through: usize = rows.iter().map(|row| row.through).sum();
        format!(
            "# Flanks of cuts in windows without contact\n\n\
             {} rays drawn inside the training domain of {}, of those whose rigid panels overlap in the plane beside the hole at the end; windows of the tier {}. \
             Nearest: least distance of the flanks along the ray where both are within a thickness of one height, negative where they pass \
             through each other. In {touching} windows flanks do, in {through} of {increments} increments. `kirigami-studies flanks`.\n",
            rows.len(),
            self.weights.display(),
            self.tier,
        )
    }
}

fn table<'a>(thickness: f64) -> Table<'a, Row> {
    let end = |row: &Row| row.hinge.path.at(1.0);
    Table::new()
        .column("w_lig / t", move |row: &Row| {
            Cell::fixed(row.hinge.design.w_lig / thickness, 1)
        })
        .column("alpha, deg", |row| {
            Cell::fixed(row.hinge.design.alpha.to_degrees(), 0)
        })
        .column("eta_a", move |row| {
            Cell::fixed(end(row).a / row.hinge.design.w_lig, 3)
        })
        .column("eta_s", move |row| {
            Cell::fixed(end(row).s / row.hinge.design.w_lig, 3)
        })
        .column("theta, deg", move |row| {
            Cell::fixed(end(row).theta.to_degrees(), 1)
        })
        .column("solved, %", |row| Cell::percent(row.lambda, 0))
        .column("rigid panels, mm", move |row| {
            Cell::fixed(gap_at_hole(&row.hinge.design, &end(row)), 2)
        })
        .column("nearest, mm", |row| {
            Cell::known(row.nearest.map(|gap| Cell::fixed(gap, 2)), "-")
        })
        .column("height, mm", |row| Cell::fixed(row.height, 1))
}
