//! Prints what equilibrium paths cost, for linear sheets of growing size: corrections, factorisations, increments, jumps,
//! CPU seconds of one thread, and the exponent with which the time grows from one sheet to the next.
//!
//! ```sh
//! cargo run --release -p design --example path_costs -- 10000      # up to 10 000 panels
//! ```
//!
//! Uniform sheets of m x n panels of 1 mm, r = 0.45, k_a = k_s = 1000 N/mm, k_theta = 0.1 N mm/rad, hinge point at the
//! corner; a pin at the middle of the west edge, a roller at the middle of the east edge, which is pulled in ten load
//! steps.

use design::equilibrium::hinged_sheet::HingedSheet;
use design::equilibrium::load_step::LoadStep;
use design::equilibrium::settings::SolverSettings;
use design::equilibrium::solver::EquilibriumSolver;
use design::equilibrium::supports::{Dof, Load, Support};
use design::hinge_law::{HingeLaw, LinearLaw};
use design::pattern::coordinates::{PatternCoordinates, logit};
use design::pattern::cut_pattern::{CutPattern, Outline};
use design::pattern::grid::Grid;
use design::sheet::cut_sheet::{Centroid, HingePoint, Sheet, SheetOptions};
use hinge::HingeConstants;

/// Columns, rows and load (N).
const SHEETS: [(usize, usize, f64); 6] = [
    (7, 7, 3.0),
    (15, 10, 6.0),
    (30, 20, 12.0),
    (60, 40, 24.0),
    (100, 100, 40.0),
    (300, 300, 120.0),
];
const STEPS: usize = 10;

fn sheet(grid: Grid) -> Sheet {
    let mut coordinates = PatternCoordinates::uniform(grid);
    coordinates.z.fill(logit(0.45));
    let outline = Outline::rectangle(grid.m as f64, grid.n as f64);
    let pattern = CutPattern::new(grid, outline, &coordinates).expect("the pattern is uniform");
    let options = SheetOptions {
        hinge_point: HingePoint::Corner,
        centroid: Centroid::Vertices,
        process: HingeConstants::PAPER,
    };
    let widths = vec![0.1; grid.hinge_count()];
    Sheet::new(&pattern, &widths, options).expect("the sheet is uniform")
}

fn path(grid: Grid, load: f64) -> (Vec<LoadStep>, f64) {
    let sheet = sheet(grid);
    let law = LinearLaw::uniform([1000.0, 1000.0, 0.1], grid.hinge_count());
    let law = law.expect("the constants are positive");
    let [west, east] = [0, grid.m - 1].map(|column| grid.panel(column, grid.n / 2));
    let held = [(west, Dof::UX), (west, Dof::UY), (east, Dof::UY)];
    let supports = held.map(|(panel, dof)| Support {
        panel,
        dof,
        value: 0.0,
    });
    let pull = Load {
        panel: east,
        dof: Dof::UX,
        value: load,
    };
    let settings = SolverSettings::default();
    let solver = EquilibriumSolver::new(grid, &supports, &[pull], STEPS, settings);
    let solver = solver.expect("pin and roller hold the sheet");
    let law = law.prepare(&sheet.designs());
    let begin = cpu_seconds();
    let path = solver.path(HingedSheet {
        sheet: &sheet,
        law: &*law,
        contact: None,
        damage_gradient: false,
    });
    (path, cpu_seconds() - begin)
}

/// CPU time of this process (s), which other processes of the machine do not lengthen.
fn cpu_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/schedstat").unwrap_or_default();
    let first = text
        .split_whitespace()
        .next()
        .and_then(|ns| ns.parse().ok());
    first.unwrap_or(f64::NAN) * 1e-9
}

fn main() {
    let largest = std::env::args().nth(1);
    let largest = largest.map_or(10_000, |text| text.parse().expect("a number of panels"));
    println!(
        "| panels | corrections | factorisations | increments | rejected | jumps | CPU s | exponent | potential, N mm |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let mut before: Option<(f64, f64)> = None;
    for (m, n, load) in SHEETS.into_iter().filter(|(m, n, _)| m * n <= largest) {
        let (path, seconds) = path(Grid { m, n }, load);
        let total = |of: fn(&LoadStep) -> usize| path.iter().map(of).sum::<usize>();
        let panels = (m * n) as f64;
        let exponent = before.map_or(String::new(), |(smaller, faster)| {
            format!("{:.2}", (seconds / faster).ln() / (panels / smaller).ln())
        });
        println!(
            "| {m} x {n} | {} | {} | {} | {} | {} | {seconds:.4} | {exponent} | {:.8e} |",
            total(|step| step.effort.iterations),
            total(|step| step.effort.factorisations),
            total(|step| step.effort.increments),
            total(|step| step.effort.rejected),
            total(|step| step.jumps),
            path.last().map_or(f64::NAN, |step| step.potential),
        );
        before = Some((panels, seconds));
    }
}
