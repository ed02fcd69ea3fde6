//! The gradient in the constants of the design problem (loads, spring constants, outline) by finite differences.

use crate::cases::AT_CORNER;
use crate::derivatives::central_slope;
use crate::taylor::{GRID, problem, start};
use design::equilibrium::settings::SolverSettings;
use design::equilibrium::solver::EquilibriumSolver;
use design::equilibrium::supports::{Dof, Load, Support};
use design::hinge_law::LinearLaw;
use design::objective::design_problem::{DesignProblem, Mechanics, Model};
use std::sync::Arc;

/// Forces on panel 5 and a couple on panel 8, then (k_a, k_s, k_theta) of every hinge.
fn loaded(x: &[f64], stroke: Option<f64>) -> DesignProblem {
    let support = |dof| Support {
        panel: 3,
        dof,
        value: 0.0,
    };
    let load = |panel, dof, value| Load { panel, dof, value };
    let loads = [
        load(5, Dof::UX, x[0]),
        load(5, Dof::UY, x[1]),
        load(8, Dof::Phi, x[2]),
    ];
    let (supports, settings) = (Dof::ALL.map(support), SolverSettings::default());
    let solver = EquilibriumSolver::new(GRID, &supports, &loads, 3, settings).unwrap();
    let stiffness = x[3..].chunks(3).map(|k| [k[0], k[1], k[2]]).collect();
    let model = Model::Equilibrium(Box::new(Mechanics {
        law: Arc::new(LinearLaw { stiffness }),
        release: None,
        contact: None,
        solver: match stroke {
            Some(stroke) => solver.driven(stroke).unwrap(),
            None => solver,
        },
    }));
    problem(model, AT_CORNER.hinge_point)
}

#[test]
fn loads_and_spring_constants() {
    let mut x = vec![9.0, 4.0, 200.0];
    x.extend([20.0, 12.0, 1500.0].repeat(GRID.hinge_count()));
    for stroke in [None, Some(50.0)] {
        let evaluation = loaded(&x, stroke).evaluate(&start()).unwrap();
        let found = &evaluation.sensitivities;
        let [force, couple] = [found.loads[5], found.loads[8]];
        let mut gradient = vec![force[0], force[1], couple[2]];
        gradient.extend(found.constants.as_flattened());
        for (i, found) in gradient.iter().enumerate() {
            let unit: Vec<f64> = (0..x.len()).map(|j| f64::from(i == j)).collect();
            let value = |x: &[f64]| loaded(x, stroke).loss(&start()).unwrap();
            let slope = central_slope(value, &x, &unit, 1e-4 * x[i]);
            let size = evaluation.loss / x[i].abs();
            assert!(
                (found - slope).abs() < 1e-6 * size,
                "{stroke:?} {i}: {found} {slope}"
            );
        }
    }
}

#[test]
fn outline_corners() {
    let mut x = vec![9.0, 4.0, 200.0];
    x.extend([20.0, 12.0, 1500.0].repeat(GRID.hinge_count()));
    let problem_on = |corners: &[f64]| {
        let mut problem = loaded(&x, None);
        problem.outline.corners = std::array::from_fn(|k| [corners[2 * k], corners[2 * k + 1]]);
        problem
    };
    let corners = [0.0, 5.0, 310.0, -8.0, 290.0, 305.0, -12.0, 300.0];
    let evaluation = problem_on(&corners).evaluate(&start()).unwrap();
    for (i, found) in evaluation
        .sensitivities
        .outline
        .as_flattened()
        .iter()
        .enumerate()
    {
        let unit: Vec<f64> = (0..8).map(|j| f64::from(i == j)).collect();
        let value = |x: &[f64]| problem_on(x).loss(&start()).unwrap();
        let slope = central_slope(value, &corners, &unit, 1e-3);
        assert!(
            (found - slope).abs() < 1e-6 * evaluation.loss / 300.0 + 1e-5,
            "{i}: {found} {slope}"
        );
    }
}
