//! The set of designs that reach one shape, section 3.1: the curvature of the objective at one of
//! them, and the distribution of many of them.

use crate::objective::design_problem::{DesignError, DesignProblem};
use crate::pattern::design_vector::DesignVector;
use faer::{Mat, Side};

/// Step of the central differences of the gradient, in the chart coordinates: small enough to
/// stay on one smooth piece of the Chamfer distance, large enough that rounding stays at 1e-8 of a slope.
const STEP: f64 = 1e-6;

/// Eigenvalues of the Hessian of the loss in the pattern's coordinates and the opening, in descending
/// order; the ligament widths are omitted, since the loss of pins does not depend on them.
///
/// Computed by central differences of the exact gradient.
pub fn curvatures(problem: &DesignProblem, design: &DesignVector) -> Result<Vec<f64>, DesignError> {
    let x = design.to_flat();
    let widths = x.len() - design.omega.len() - usize::from(design.opening.is_some());
    let coordinates: Vec<_> = (0..x.len())
        .filter(|i| !(widths..widths + design.omega.len()).contains(i))
        .collect();
    let mut columns = Vec::new();
    for &i in &coordinates {
        let gradient = |step: f64| {
            let mut beside = x.clone();
            beside[i] += step;
            let evaluation = problem.evaluate(&design.with_flat(&beside))?;
            Ok::<_, DesignError>(evaluation.gradient.to_flat())
        };
        let (ahead, behind) = (gradient(STEP)?, gradient(-STEP)?);
        let slopes = std::iter::zip(ahead, behind).map(|(a, b)| 0.5 * (a - b) / STEP);
        columns.push(slopes.collect::<Vec<_>>());
    }
    let n = coordinates.len();
    let hessian = Mat::from_fn(n, n, |i, j| {
        0.5 * (columns[j][coordinates[i]] + columns[i][coordinates[j]])
    });
    Ok(descending(&hessian).0)
}

/// Eigenvalues in descending order with their eigenvectors; empty if the matrix is not finite.
fn descending(symmetric: &Mat<f64>) -> (Vec<f64>, Vec<Vec<f64>>) {
    let Ok(eigen) = symmetric.self_adjoint_eigen(Side::Lower) else {
        return (Vec::new(), Vec::new());
    };
    let n = symmetric.nrows();
    let values = (0..n).rev().map(|k| eigen.S()[k]).collect();
    let vectors = (0..n)
        .rev()
        .map(|k| (0..n).map(|i| eigen.U()[(i, k)]).collect());
    (values, vectors.collect())
}

/// The plane of the two largest principal components of a set of points.
#[derive(Clone, Debug, PartialEq)]
pub struct PrincipalPlane {
    /// Mean of the points, the origin of the plane.
    pub mean: Vec<f64>,
    /// Unit vectors.
    pub axes: [Vec<f64>; 2],
    /// Fraction of the variance along each axis.
    pub shares: [f64; 2],
}

impl PrincipalPlane {
    /// For points of the same length; `None` for fewer than two coordinates or points.
    pub fn of(points: &[Vec<f64>]) -> Option<Self> {
        let (count, n) = (points.len(), points.first()?.len());
        if count < 2 || n < 2 {
            return None;
        }
        let mean: Vec<f64> = (0..n)
            .map(|i| points.iter().map(|point| point[i]).sum::<f64>() / count as f64)
            .collect();
        let covariance = Mat::from_fn(n, n, |i, j| {
            let products = points
                .iter()
                .map(|point| (point[i] - mean[i]) * (point[j] - mean[j]));
            products.sum::<f64>() / count as f64
        });
        let (variances, mut axes) = descending(&covariance);
        let total: f64 = variances.iter().sum();
        axes.truncate(2);
        let axes = axes.try_into().ok()?;
        Some(Self {
            mean,
            axes,
            shares: [variances[0] / total, variances[1] / total],
        })
    }

    /// The coordinates of a point in the plane.
    pub fn place(&self, point: &[f64]) -> [f64; 2] {
        let along = |axis: &Vec<f64>| {
            let offsets = std::iter::zip(point, &self.mean).map(|(x, mean)| x - mean);
            std::iter::zip(offsets, axis)
                .map(|(offset, axis)| offset * axis)
                .sum()
        };
        [along(&self.axes[0]), along(&self.axes[1])]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_principal_plane_of_a_flat_ellipse_is_its_plane() {
        let points: Vec<Vec<f64>> = (0..60)
            .map(|k| {
                let angle = 0.1 * std::f64::consts::PI * f64::from(k) / 3.0;
                vec![1.0, 2.0 + angle.sin(), 3.0 + 5.0 * angle.cos()]
            })
            .collect();
        let plane = PrincipalPlane::of(&points).unwrap();
        assert!((plane.axes[0][2].abs() - 1.0).abs() < 1e-12, "{plane:?}");
        assert!((plane.axes[1][1].abs() - 1.0).abs() < 1e-12, "{plane:?}");
        assert!((plane.shares[0] / plane.shares[1] - 25.0).abs() < 1e-9);
        let [along, across] = plane.place(&[7.0, 2.0, 8.0]);
        assert!((along.abs() - 5.0).abs() < 1e-12 && across.abs() < 1e-12);
        assert_eq!(PrincipalPlane::of(&points[..1]), None);
    }
}
