//! Prints the error of the design gradient as a function of the conditioning of the tangent and of the
//! solver tolerance, and a comparison of Newton's method with L-BFGS.
//!
//! The sheet is a random one of 5 x 4 panels of 1 x 1 with the linear law, clamped in the west and pulled in the
//! east in five load steps. The error is the difference of the slope along a random direction from central
//! differences of fourth order of the loss, computed at the tightest tolerance.

use design::equilibrium::settings::{Method, SolverSettings};
use design::equilibrium::solver::EquilibriumSolver;
use design::equilibrium::supports::{Dof, Load, Support};
use design::geometry::chamfer::{Chamfer, Precision};
use design::hinge_law::{DamageMeasure, LinearLaw};
use design::objective::design_problem::{DesignProblem, Mechanics, Model};
use design::objective::loss::{Objective, OutlinePoints};
use design::objective::path_functionals::PerFunctional;
use design::pattern::coordinates::PatternCoordinates;
use design::pattern::cut_pattern::Outline;
use design::pattern::design_vector::{DesignVector, WidthChart};
use design::pattern::grid::Grid;
use design::sheet::cut_sheet::{Centroid, HingePoint, SheetOptions};
use hinge::HingeConstants;
use std::sync::Arc;
use std::time::Instant;

const TIGHT: f64 = 1e-13;

fn settings(method: Method, tolerance: f64) -> SolverSettings {
    SolverSettings {
        method,
        tolerance,
        loose_tolerance: f64::max(1e-6, tolerance),
        ..SolverSettings::default()
    }
}

fn problem(grid: Grid, stiffness: f64, settings: SolverSettings) -> DesignProblem {
    let Grid { m, n } = grid;
    let west = m * (n / 2);
    let support = |dof| Support {
        panel: west,
        dof,
        value: 0.0,
    };
    let pull = Load {
        panel: west + m - 1,
        dof: Dof::UX,
        value: n as f64,
    };
    let target = (0..200).map(|i| {
        let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 200.0).sin_cos();
        [m as f64 * cos, n as f64 * sin]
    });
    let supports = Dof::ALL.map(support);
    let law = LinearLaw::uniform([stiffness, stiffness, 1.0], grid.hinge_count());
    let mechanics = Mechanics {
        law: Arc::new(law.expect("the constants are positive")),
        contact: None,
        solver: EquilibriumSolver::new(grid, &supports, &[pull], 5, settings)
            .expect("the sheet is clamped"),
    };
    let per = |compression, shear| PerFunctional {
        damage: 0.0,
        compression,
        shear,
    };
    DesignProblem {
        grid,
        outline: Outline::rectangle(m as f64, n as f64),
        widths: WidthChart {
            w_minus: 0.08,
            w_plus: 0.24,
        },
        options: SheetOptions {
            hinge_point: HingePoint::Corner,
            centroid: Centroid::Area,
            process: HingeConstants {
                fillet_ratio: 0.16,
                kerf: 0.2,
                r_win: 100.0,
            },
        },
        model: Model::Equilibrium(Box::new(mechanics)),
        objective: Objective {
            target: target.collect(),
            chamfer: Chamfer {
                coverage_weight: 0.5,
                smoothing: 0.05,
                precision: Precision::Samples,
            },
            outline: OutlinePoints::Free,
            centred: true,
            panel_shape: 0.0,
            least_distance: 0.0,
            min_panel_width: 0.0,
            domain: None,
            weights: per(0.1, 0.1),
            damage_measure: DamageMeasure::Mean,
            temperatures: per(0.02, 0.02),
        },
    }
}

fn start(grid: Grid) -> DesignVector {
    let mut wave = (1..).map(|i: i32| 0.4 * f64::from(i * i).sin());
    let mut pattern = PatternCoordinates::uniform(grid);
    let edges = pattern.ell.iter_mut().flatten();
    for (x, wave) in pattern.z.iter_mut().chain(edges).zip(&mut wave) {
        *x = wave;
    }
    DesignVector {
        pattern,
        ..DesignVector::uniform(grid)
    }
}

/// The slope along a fixed direction by fourth-order differences.
fn slope(problem: &DesignProblem, design: &DesignVector, direction: &[f64]) -> f64 {
    let x = design.to_flat();
    let loss = |h: f64| {
        let beside: Vec<f64> = std::iter::zip(&x, direction)
            .map(|(x, d)| x + h * d)
            .collect();
        let beside = design.with_flat(&beside);
        problem.loss(&beside).expect("the sheet has an equilibrium")
    };
    let h = 1e-3;
    (8.0 * (loss(h) - loss(-h)) - (loss(2.0 * h) - loss(-2.0 * h))) / (12.0 * h)
}

/// Condition estimate, maximum adjoint residual, and error of the slope.
fn gradient_error(stiffness: f64, tolerance: f64) -> [f64; 3] {
    let grid = Grid { m: 5, n: 4 };
    let design = start(grid);
    let direction: Vec<f64> = (0..design.to_flat().len())
        .map(|i| ((3 * i * i + 1) as f64).sin())
        .collect();
    let exact = problem(grid, stiffness, settings(Method::Newton, TIGHT));
    let expected = slope(&exact, &design, &direction);
    let inexact = problem(grid, stiffness, settings(Method::Newton, tolerance));
    let evaluation = inexact
        .evaluate(&design)
        .expect("the sheet has an equilibrium");
    let found: f64 = std::iter::zip(evaluation.gradient.to_flat(), direction)
        .map(|(g, d)| g * d)
        .sum();
    let Model::Equilibrium(mechanics) = &inexact.model else {
        unreachable!("the problem has mechanics");
    };
    let conditions = evaluation.deployment.path.iter();
    let condition = conditions.map(|step| step.condition(&mechanics.solver));
    [
        condition.fold(0.0, f64::max),
        evaluation.adjoint_residual,
        (found / expected - 1.0).abs(),
    ]
}

fn main() {
    println!("k_a/k_theta  cond(H)  adjoint residual  gradient error");
    for exponent in 0..=6 {
        let stiffness = 10_f64.powi(exponent);
        let [condition, residual, error] = gradient_error(stiffness, TIGHT);
        println!("{stiffness:>11.0e} {condition:>8.1e} {residual:>17.1e} {error:>15.1e}");
    }
    println!("\ntolerance  gradient error at k_a/k_theta = 1e4");
    for exponent in [-2, -3, -4, -6, -8, -10, -12] {
        let tolerance = 10_f64.powi(exponent);
        let [.., error] = gradient_error(1e4, tolerance);
        println!("{tolerance:>9.0e} {error:>15.1e}");
    }
    println!("\npanels  method  iterations  seconds  (residual 1e-8, k_a/k_theta = 1e4)");
    for grid in [Grid { m: 7, n: 7 }, Grid { m: 15, n: 10 }] {
        let lbfgs = Method::Lbfgs {
            max_iterations: 200_000,
        };
        for (name, method) in [("Newton", Method::Newton), ("L-BFGS", lbfgs)] {
            let problem = problem(grid, 1e4, settings(method, 1e-8));
            let begin = Instant::now();
            let path = problem
                .deploy(&start(grid))
                .expect("the sheet can be cut")
                .path;
            let seconds = begin.elapsed().as_secs_f64();
            let iterations: usize = path.iter().map(|step| step.iterations).sum();
            let last = &path[path.len() - 1];
            println!(
                "{:>6}  {name}  {iterations:>10} {seconds:>8.3}  {:?} {:.0e} {:.9}",
                grid.panel_count(),
                last.status,
                last.residual,
                last.potential
            );
        }
    }
}
