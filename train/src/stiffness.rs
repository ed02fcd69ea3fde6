//! The learned tangent compared with the finite elements: curvature of the energy along rays.
//!
//! Between two increments of a ray, the curvature of the finite elements is
//!
//! ```text
//! d2W/dlambda2  ~  (F_2 - F_1) . (eps_2 - eps_1) / (lambda_2 - lambda_1)^2
//! ```
//!
//! and that of the surrogate is (eps_2 - eps_1)' H (eps_2 - eps_1) / (lambda_2 - lambda_1)^2, evaluated at the middle.

use crate::validation::fit_error;
use dataset::Row;
use hinge::HingeDeformation;
use surrogate::{FitError, Order, Surrogate};

/// Comparison of the learned tangent with the finite elements on a set of rays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StiffnessCheck {
    /// Number of pairs of increments.
    pub pairs: usize,
    /// Fraction of the states whose learned tangent is not positive definite.
    pub indefinite: f64,
    /// Fraction of the pairs with negative curvature in the finite elements.
    pub softening: f64,
    /// Fraction of the pairs with negative learned curvature.
    pub learned_softening: f64,
    /// Error of the learned curvature along the rays.
    pub curvature: FitError,
}

impl StiffnessCheck {
    /// Compares the tangents on `rows`, which must be in the order of job and lambda, as in a database.
    pub fn new(surrogate: &Surrogate, rows: &[Row]) -> Self {
        let pairs: Vec<(&Row, &Row)> = rows
            .iter()
            .zip(rows.iter().skip(1))
            .filter(|(left, right)| left.job == right.job)
            .collect();
        let designs: Vec<_> = pairs.iter().map(|(left, _)| left.design).collect();
        let middles: Vec<HingeDeformation> = pairs.iter().map(|pair| between(pair, 0.5)).collect();
        let prepared = surrogate.prepare(&designs);
        let energies = surrogate.evaluate(&prepared, &middles, Order::Tangent);
        let points: Vec<[f64; 2]> = std::iter::zip(&pairs, &energies)
            .map(|(pair, energy)| [curvature(pair), along(&energy.tangent, pair)])
            .collect();
        let fraction = |count: usize| count as f64 / pairs.len().max(1) as f64;
        let negative = |of: usize| fraction(points.iter().filter(|point| point[of] < 0.0).count());
        let indefinite = energies.iter().filter(|energy| !positive(&energy.tangent));
        Self {
            pairs: pairs.len(),
            indefinite: fraction(indefinite.count()),
            softening: negative(0),
            learned_softening: negative(1),
            curvature: fit_error(points.into_iter()),
        }
    }
}

/// The deformation at the fraction `share` between two increments.
fn between((left, right): &(&Row, &Row), share: f64) -> HingeDeformation {
    let (from, to) = (left.sample.deformation(), right.sample.deformation());
    let (from, to) = (from.to_array(), to.to_array());
    HingeDeformation::from([0, 1, 2].map(|k| from[k] + share * (to[k] - from[k])))
}

/// d eps / d lambda.
fn direction((left, right): &(&Row, &Row)) -> [f64; 3] {
    let step = right.sample.lambda - left.sample.lambda;
    let (from, to) = (left.sample.deformation(), right.sample.deformation());
    let (from, to) = (from.to_array(), to.to_array());
    [0, 1, 2].map(|k| (to[k] - from[k]) / step)
}

/// The curvature of the finite elements.
fn curvature(pair: &(&Row, &Row)) -> f64 {
    let (left, right) = (pair.0.sample, pair.1.sample);
    let change = [
        right.f_a - left.f_a,
        right.f_s - left.f_s,
        right.m_theta - left.m_theta,
    ];
    let products = direction(pair).into_iter().zip(change);
    products.map(|(d, f)| d * f).sum::<f64>() / (right.lambda - left.lambda)
}

/// The curvature of the learned tangent.
fn along(tangent: &[[f64; 3]; 3], pair: &(&Row, &Row)) -> f64 {
    let d = direction(pair);
    let row = |i: usize| d[i] * (0..3).map(|j| tangent[i][j] * d[j]).sum::<f64>();
    (0..3).map(row).sum()
}

/// Whether a matrix is positive definite, by Sylvester's criterion.
fn positive(h: &[[f64; 3]; 3]) -> bool {
    let minor = h[0][0] * h[1][1] - h[0][1] * h[1][0];
    let determinant = h[0][2] * (h[1][0] * h[2][1] - h[1][1] * h[2][0])
        - h[1][2] * (h[0][0] * h[2][1] - h[0][1] * h[2][0])
        + h[2][2] * minor;
    h[0][0] > 0.0 && minor > 0.0 && determinant > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn definite_and_indefinite_matrices_are_distinguished() {
        assert!(positive(&[
            [2.0, 1.0, 0.0],
            [1.0, 2.0, 1.0],
            [0.0, 1.0, 2.0]
        ]));
        assert!(!positive(&[
            [1.0, 2.0, 0.0],
            [2.0, 1.0, 0.0],
            [0.0, 0.0, 1.0]
        ]));
        assert!(!positive(&[
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, -1.0]
        ]));
    }
}
