//! The Hessian of the loss by Gauss-Newton for the shape, on which the memory of L-BFGS is built.
//!
//! With the gradients v_k of [`DesignProblem::shape_curvature`], the rows of V, the memory starts from
//!
//! ```text
//! H_0 = V^T V + mu I,     H_0^-1 g = (g - V^T (V V^T + mu I)^-1 V g) / mu
//! ```
//!
//! instead of a multiple of I. It needs a dense factorisation whose size is twice the number of outline points. mu is
//! the change of the gradient along the last step that V^T V does not explain, over the length of the step. Where the
//! step is too long, mu is raised (Levenberg), up to a million times; then the step is shortened.
//!
//! [`DesignProblem::shape_curvature`]: crate::objective::design_problem::DesignProblem::shape_curvature

use crate::equilibrium::displacement_control::dot;
use crate::optimise::lbfgs_memory::{Memory, reach, shortened};
use faer::linalg::solvers::{Llt, Solve};
use faer::{Mat, Side};

/// Smallest mu over the largest diagonal entry of V V^T.
const LEAST: f64 = 1e-9;
/// Factor by which mu is raised, and how often at most; a step that is still too long is shortened.
const RAISE: (f64, usize) = (4.0, 10);

/// V and V V^T.
pub(crate) struct ShapeCurvature {
    rows: Vec<Vec<f64>>,
    products: Mat<f64>,
}

impl ShapeCurvature {
    pub(crate) fn new(rows: Vec<Vec<f64>>) -> Self {
        let products = Mat::from_fn(rows.len(), rows.len(), |i, j| dot(&rows[i], &rows[j]));
        Self { rows, products }
    }

    /// The step against the gradient; no coordinate of it is longer than `longest`.
    pub(crate) fn step(&self, gradient: &[f64], memory: &Memory, longest: f64) -> Vec<f64> {
        let diagonal = (0..self.rows.len()).map(|k| self.products[(k, k)]);
        let least = LEAST * diagonal.fold(f64::MIN_POSITIVE, f64::max);
        let mut mu = self.unexplained(memory).max(least);
        let mut step = Vec::new();
        for _ in 0..RAISE.1 {
            if let Some(found) = self.damped(gradient, memory, mu) {
                step = found;
                if reach(&step) <= longest {
                    return step;
                }
            }
            mu *= RAISE.0;
        }
        shortened(step, longest)
    }

    /// mu by the last step; 0 before the first.
    fn unexplained(&self, memory: &Memory) -> f64 {
        let Some((step, change)) = memory.last() else {
            return 0.0;
        };
        let mut rest = change.to_vec();
        self.add(&mut rest, self.times(step).into_iter().map(|along| -along));
        (dot(&rest, &rest) / dot(step, step)).sqrt()
    }

    /// The step with a given mu; `None` if V V^T + mu I is not positive definite beyond rounding.
    fn damped(&self, gradient: &[f64], memory: &Memory, mu: f64) -> Option<Vec<f64>> {
        let n = self.rows.len();
        let damped = Mat::from_fn(n, n, |i, j| {
            self.products[(i, j)] + if i == j { mu } else { 0.0 }
        });
        let factor = Llt::new(damped.as_ref(), Side::Lower).ok()?;
        let step = memory.direction_from(gradient, |x| {
            let along = self.times(x);
            let solved = factor.solve(Mat::from_fn(n, 1, |k, _| along[k]));
            self.add(x, (0..n).map(|k| -solved[(k, 0)]));
            x.iter_mut().for_each(|entry| *entry /= mu);
        });
        step.iter().all(|entry| entry.is_finite()).then_some(step)
    }

    /// V x
    fn times(&self, x: &[f64]) -> Vec<f64> {
        self.rows.iter().map(|row| dot(row, x)).collect()
    }

    /// x += V^T y
    fn add(&self, x: &mut [f64], y: impl Iterator<Item = f64>) {
        for (row, weight) in self.rows.iter().zip(y) {
            std::iter::zip(&mut *x, row).for_each(|(x, entry)| *x += weight * entry);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rows in three coordinates.
    fn curvature() -> ShapeCurvature {
        ShapeCurvature::new(vec![vec![3.0, 0.0, 1.0], vec![0.0, 2.0, -1.0]])
    }

    /// H_0 x
    fn hessian(x: &[f64], mu: f64) -> Vec<f64> {
        let curvature = curvature();
        let mut product: Vec<f64> = x.iter().map(|entry| mu * entry).collect();
        curvature.add(&mut product, curvature.times(x).into_iter());
        product
    }

    #[test]
    fn the_step_is_that_of_newton_on_a_quadratic_loss() {
        let gradient = [1.0, -2.0, 0.5];
        let step = curvature()
            .damped(&gradient, &Memory::default(), 0.3)
            .unwrap();
        let back = hessian(&step, 0.3);
        let error = std::iter::zip(back, gradient).map(|(back, g)| (back + g).abs());
        // The entries of the matrix and of the step are of the size 10.
        assert!(error.fold(0.0, f64::max) < 1e-12);
        // The pair of a step gives mu and satisfies the secant equation.
        let mut memory = Memory::default();
        memory.remember(vec![0.1, 0.2, -0.1], hessian(&[0.1, 0.2, -0.1], 0.3));
        assert!((curvature().unexplained(&memory) - 0.3).abs() < 1e-14);
        let again = curvature().step(&gradient, &memory, 1e9);
        let error = std::iter::zip(again, step).map(|(again, step)| (again - step).abs());
        assert!(error.fold(0.0, f64::max) < 1e-12);
    }

    #[test]
    fn a_step_that_is_too_long_is_shortened_and_descends() {
        let gradient = [1.0, -2.0, 0.5];
        for longest in [10.0, 1e-3] {
            let step = curvature().step(&gradient, &Memory::default(), longest);
            assert!(reach(&step) <= longest * (1.0 + 1e-12) && reach(&step) > 0.2 * longest);
            assert!(dot(&step, &gradient) < 0.0);
        }
    }
}
