//! The gradient in the constants of the design problem (loads, spring constants, outline) by finite
//! differences.

use crate::prelude::*;
use crate::taylor::{GRID, problem, start};

/// Forces on panel 5 and a couple on panel 8, then (k_a, k_s, k_theta) of every hinge.
fn loaded(x: &[f64], stroke: Option<f64>) -> DesignProblem {
    let loads = [pull(5, x[0]), load(5, Dof::UY, x[1]), load(8, Dof::Phi, x[2])];
    let solver = solver(GRID, &clamp(3), &loads, 3);
    let solver = match stroke {
        Some(stroke) => solver.driven(stroke).unwrap(),
        None => solver,
    };
    let stiffness = x[3..].as_chunks().0.to_vec();
    problem(mechanics(LinearLaw { stiffness }, solver), AT_CORNER.hinge_point)
}

fn constants() -> Vec<f64> {
    let springs = [20.0, 12.0, 1500.0].repeat(GRID.hinge_count());
    [vec![9.0, 4.0, 200.0], springs].concat()
}

#[test]
fn loads_and_spring_constants() {
    let x = constants();
    for stroke in [None, Some(50.0)] {
        let evaluation = loaded(&x, stroke).evaluate(&start()).unwrap();
        let found = &evaluation.sensitivities;
        let [force, couple] = [found.loads[5], found.loads[8]];
        let mut gradient = vec![force[0], force[1], couple[2]];
        gradient.extend(found.constants.as_flattened());
        // In units of the constants.
        let relative: Vec<f64> = std::iter::zip(&gradient, &x).map(|(g, x)| g * x).collect();
        let value = |factors: &[f64]| {
            let scaled = std::iter::zip(factors, &x).map(|(factor, x)| factor * x);
            loaded(&scaled.collect::<Vec<_>>(), stroke).loss(&start()).unwrap()
        };
        let allowed = |_| 1e-6 * evaluation.loss;
        assert_gradient(value, &vec![1.0; x.len()], &relative, 1e-4, allowed);
    }
}

#[test]
fn outline_corners() {
    let x = constants();
    let problem_on = |corners: &[f64]| {
        let mut problem = loaded(&x, None);
        problem.outline.corners = std::array::from_fn(|k| [corners[2 * k], corners[2 * k + 1]]);
        problem
    };
    let corners = [0.0, 5.0, 310.0, -8.0, 290.0, 305.0, -12.0, 300.0];
    let evaluation = problem_on(&corners).evaluate(&start()).unwrap();
    let value = |x: &[f64]| problem_on(x).loss(&start()).unwrap();
    let found = evaluation.sensitivities.outline.as_flattened();
    let allowed = |_| 1e-6 * evaluation.loss / 300.0 + 1e-5;
    assert_gradient(value, &corners, found, 1e-3, allowed);
}
