//! Uniform sheets with linear hinges.

use crate::charts::PathCost;
use crate::path_costs::{effort, jumps, timed};
use anyhow::Result;
use design::LinearLaw;
use design::equilibrium::load_step::Effort;
use design::equilibrium::settings::SolverSettings;
use design::equilibrium::solver::EquilibriumSolver;
use design::equilibrium::supports::{Dof, Load, Support};
use design::objective::design_problem::{DesignProblem, Mechanics, Model};
use design::objective::loss::Objective;
use design::objective::shape::Shape;
use design::pattern::coordinates::logit;
use design::pattern::cut_pattern::Outline;
use design::pattern::design_vector::{DesignVector, WidthChart};
use design::pattern::grid::Grid;
use design::sheet::cut_sheet::{HingePoint, SheetOptions};
use hinge::HingeConstants;
use std::fmt::Write;
use std::sync::Arc;

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
/// (k_a, k_s, k_theta) in N/mm, N/mm and N mm.
const SPRINGS: [f64; 3] = [1000.0, 1000.0, 0.1];
const ASPECT_RATIO: f64 = 0.45;
/// Paths are repeated until they have followed about this number of panels.
const REPEATED: usize = 10_000;
/// Maximum number of measurements.
const ROUNDS: usize = 3;

/// A sheet and the costs of its path.
pub struct Measured {
    grid: Grid,
    effort: Effort,
    jumps: usize,
    potential: f64,
    factor_entries: usize,
    pub cost: PathCost,
}

/// The sheets with at most `panels` panels.
pub fn sheets(panels: usize) -> Vec<(Grid, f64)> {
    let sheets = SHEETS.into_iter().map(|(m, n, load)| (Grid { m, n }, load));
    sheets
        .filter(|(grid, _)| grid.panel_count() <= panels)
        .collect()
}

/// A pin at the middle of the west edge, a roller at the middle of the east edge, which is pulled.
fn problem(grid: Grid, load: f64) -> Result<(DesignProblem, usize)> {
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
    let solver = EquilibriumSolver::new(grid, &supports, &[pull], STEPS, settings)?;
    let factor_entries = solver.factor_entries();
    let (width, height) = (grid.m as f64, grid.n as f64);
    let problem = DesignProblem {
        grid,
        outline: Outline::rectangle(width, height),
        widths: WidthChart {
            w_minus: 0.05,
            w_plus: 0.15,
        },
        options: SheetOptions {
            hinge_point: HingePoint::Corner,
            process: HingeConstants::PAPER.into(),
        },
        model: Model::Equilibrium(Box::new(Mechanics {
            law: Arc::new(LinearLaw::uniform(SPRINGS, grid.hinge_count())),
            release: None,
            contact: None,
            solver,
        })),
        objective: Objective::from_shape(Shape::new(vec![
            [0.0, 0.0],
            [1.1 * width, 0.0],
            [1.1 * width, 1.1 * height],
            [0.0, 1.1 * height],
        ])),
    };
    Ok((problem, factor_entries))
}

pub fn measured((grid, load): (Grid, f64)) -> Result<Measured> {
    let (problem, factor_entries) = problem(grid, load)?;
    let mut design = DesignVector::uniform(grid);
    design.pattern.z.fill(logit(ASPECT_RATIO));
    let repeats = (REPEATED / grid.panel_count()).max(1);
    let mut cost = PathCost {
        panels: grid.panel_count(),
        path: f64::INFINITY,
        with_gradient: f64::INFINITY,
    };
    let mut found = (Effort::default(), 0, f64::NAN);
    // Other programs slow a processor down: of several measurements the shortest counts.
    for _ in 0..(ROUNDS * REPEATED / grid.panel_count()).clamp(1, ROUNDS) {
        let (deployment, seconds) = timed(repeats, || Ok(problem.deploy(&design)?))?;
        cost.path = cost.path.min(seconds);
        found = (
            effort(&deployment.path),
            jumps(&deployment.path),
            deployment.final_step().potential,
        );
        drop(deployment);
        let (_, seconds) = timed(repeats, || Ok(problem.evaluate(&design)?))?;
        cost.with_gradient = cost.with_gradient.min(seconds);
    }
    let (effort, jumps, potential) = found;
    Ok(Measured {
        grid,
        effort,
        jumps,
        potential,
        factor_entries,
        cost,
    })
}

/// Counts and times. The exponent is that of the number of panels with which the time grows from one sheet to the next.
pub fn table(sheets: &[Measured]) -> String {
    let mut text = String::from(
        "| panels | corrections | factorisations | increments | rejected | jumps | CPU s | exponent | with gradient \
         | entries of a factor, 1e6 | potential, N mm |\n\
         |---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    let mut before: Option<&PathCost> = None;
    for sheet in sheets {
        let (grid, effort, cost) = (sheet.grid, &sheet.effort, &sheet.cost);
        let exponent = before.map_or(String::new(), |before| {
            let panels = cost.panels as f64 / before.panels as f64;
            format!("{:.2}", (cost.path / before.path).ln() / panels.ln())
        });
        let _ = writeln!(
            text,
            "| {} x {} | {} | {} | {} | {} | {} | {:.4} | {exponent} | {:.2} | {:.3} | {:.8e} |",
            grid.m,
            grid.n,
            effort.iterations,
            effort.factorisations,
            effort.increments,
            effort.rejected,
            sheet.jumps,
            cost.path,
            cost.with_gradient / cost.path,
            1e-6 * sheet.factor_entries as f64,
            sheet.potential,
        );
        before = Some(cost);
    }
    text
}
