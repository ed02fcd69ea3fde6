//! Synthetic measurements of a deployed sheet with known pose, scale, noise, slip and mistakes.

mod accuracy;
mod mistakes;

use analysis::measured_openings::{MeasuredPanel, openings, scatter, slip};
use analysis::measured_points::{Mark, MeasuredPoint};
use analysis::measured_sheet::MeasuredSheet;
use analysis::shape_path::ShapePath;
use design::equilibrium::settings::SolverSettings;
use design::equilibrium::supports::{Dof, Load, Support};
use design::geometry::similarity::Scale;
use design::objective::design_problem::Deployment;
use design::sheet::cut_sheet::{HingePoint, SheetOptions};
use design::sheet::kinematics::hinge_deformations;
use design::*;
use hinge::HingeConstants;
use output::measurement::MeasurementReport;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;
use std::sync::Arc;

const GRID: Grid = Grid { m: 5, n: 10 };
/// Position on the path of the synthetic measurements: between the load steps 5 and 6.
const POSITION: f64 = 5.4;

/// A sheet of 50 panels of 100 mm, held at the left and pulled to the right, with a pattern that is
/// not uniform.
fn deployed() -> (DesignProblem, Deployment) {
    let clamp = Dof::ALL.map(|dof| Support { panel: GRID.panel(0, 4), dof, value: 0.0 });
    let pull = Load { panel: GRID.panel(4, 5), dof: Dof::UX, value: 4.0 };
    let settings = SolverSettings::default();
    let solver = EquilibriumSolver::new(GRID, &clamp, &[pull], 8, settings).unwrap();
    let law = LinearLaw::uniform([400.0, 250.0, 300.0], GRID.hinge_count());
    let problem = DesignProblem {
        topology: GRID.into(),
        outline: Outline::rectangle(500.0, 1000.0),
        widths: WidthChart { w_minus: 5.0, w_plus: 15.0 },
        options: SheetOptions {
            hinge_point: HingePoint::Corner,
            process: HingeConstants::PAPER.into(),
        },
        model: Model::Equilibrium(Box::new(Mechanics {
            law: Arc::new(law),
            contact: None,
            solver,
        })),
        objective: Objective {
            shape: ShapeDistance::new(vec![[0.0, 0.0]]),
            functionals: Vec::new(),
            penalties: Vec::new(),
        },
    };
    let mut design = DesignVector::uniform(GRID);
    for (i, z) in design.pattern.z.iter_mut().enumerate() {
        *z += 0.4 * (i as f64).sin();
    }
    let deployment = problem.deploy(&design).unwrap();
    (problem, deployment)
}

/// The marks at a position of the path, moved by a rigid motion and a scale.
fn measured(path: &ShapePath, position: f64, corners: bool, scale: f64) -> Vec<MeasuredPoint> {
    let configuration = path.at(position).configuration;
    let (sin, cos) = 0.7_f64.sin_cos();
    let marks = Mark::all(path.sheet).filter(|mark| mark.corner.is_some() == corners);
    marks
        .map(|mark| {
            let [x, y] = mark.deployed(path.sheet, &configuration);
            let position = [cos * x - sin * y, sin * x + cos * y].map(|x| scale * x);
            MeasuredPoint { mark, position: [position[0] + 3000.0, position[1] - 250.0] }
        })
        .collect()
}

fn corners(path: &ShapePath) -> Vec<MeasuredPoint> {
    measured(path, POSITION, true, 1.0)
}

/// Adds Gaussian errors of the standard deviation `sigma` to every coordinate (Box and Muller).
fn disturb(points: &mut [MeasuredPoint], sigma: f64, seed: u64) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    for point in points {
        let [u, v]: [f64; 2] = [random.random(), random.random()];
        let radius = sigma * (-2.0 * (1.0 - u).ln()).sqrt();
        point.position[0] += radius * (TAU * v).cos();
        point.position[1] += radius * (TAU * v).sin();
    }
}

fn squares(sheet: &MeasuredSheet) -> f64 {
    let points = sheet.best.points.iter();
    points.map(|point| point.distance().powi(2)).sum()
}
