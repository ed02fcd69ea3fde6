//! The set of designs that reach one shape, section 3.1: the curvature of the objective at one of
//! them, the directions in which the outline does not move, and the distribution of many solutions.

use crate::equilibrium::displacement_control::dot;
use crate::objective::design_problem::{DesignError, DesignProblem};
use crate::pattern::design_vector::DesignVector;
use faer::{Mat, Side};

/// Singular values of the outline's derivative below this fraction of the largest are rounding errors of its
/// central differences.
const ROUNDING: f64 = 1e-6;
/// Step of the central differences of the gradient, in the chart coordinates: small enough to
/// stay on one smooth piece of the Chamfer distance, large enough that rounding stays at 1e-8 of a slope.
const STEP: f64 = 1e-6;

/// Eigenvalues of the Hessian of the loss in the pattern's coordinates and the opening, in descending
/// order; the ligament widths are omitted, since the loss of pins does not depend on them.
///
/// Computed by central differences of the exact gradient.
pub fn curvatures(problem: &DesignProblem, design: &DesignVector) -> Result<Vec<f64>, DesignError> {
    let coordinates = coordinates(design);
    let columns = slopes(design, &coordinates, |beside| {
        Ok(problem.evaluate(beside)?.gradient.to_flat())
    })?;
    let n = coordinates.len();
    let hessian = Mat::from_fn(n, n, |i, j| {
        0.5 * (columns[j][coordinates[i]] + columns[i][coordinates[j]])
    });
    Ok(descending(&hessian).0)
}

/// The number of independent motions of the points P, in the position in which they are compared with the target, by
/// the coordinates of [`curvatures`]. No objective of these points depends on more directions to first order, and a design
/// moves along the others without any change of its outline.
pub fn outline_rank(problem: &DesignProblem, design: &DesignVector) -> Result<usize, DesignError> {
    let columns = slopes(design, &coordinates(design), |beside| {
        let deployment = problem.deploy(beside)?;
        let corners = problem.objective.shape.outline.corners(&deployment.sheet);
        let outline = problem
            .objective
            .shape
            .placed(&deployment.outline(&corners));
        Ok(outline.into_flattened())
    })?;
    let n = columns.len();
    let gram = Mat::from_fn(n, n, |i, j| dot(&columns[i], &columns[j]));
    let (squares, _) = descending(&gram);
    let largest = squares.first().copied().unwrap_or_default();
    Ok(squares
        .iter()
        .filter(|square| **square > ROUNDING.powi(2) * largest)
        .count())
}

/// The indices of the pattern's coordinates and of the opening in the flat vector of a design.
fn coordinates(design: &DesignVector) -> Vec<usize> {
    let n = design.to_flat().len();
    let widths = n - design.omega.len() - usize::from(design.opening.is_some());
    (0..n)
        .filter(|i| !(widths..widths + design.omega.len()).contains(i))
        .collect()
}

/// Central differences of a vector in the given coordinates, one column each.
fn slopes(
    design: &DesignVector,
    coordinates: &[usize],
    value: impl Fn(&DesignVector) -> Result<Vec<f64>, DesignError>,
) -> Result<Vec<Vec<f64>>, DesignError> {
    let x = design.to_flat();
    let column = |&i: &usize| {
        let at = |step: f64| {
            let mut beside = x.clone();
            beside[i] += step;
            value(&design.with_flat(&beside))
        };
        let slopes = std::iter::zip(at(STEP)?, at(-STEP)?).map(|(a, b)| 0.5 * (a - b) / STEP);
        Ok(slopes.collect())
    };
    coordinates.iter().map(column).collect()
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
    pub fn new(points: &[Vec<f64>]) -> Option<Self> {
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

    /// The point of given coordinates in the plane.
    pub fn point(&self, [x, y]: [f64; 2]) -> Vec<f64> {
        (0..self.mean.len())
            .map(|i| self.mean[i] + x * self.axes[0][i] + y * self.axes[1][i])
            .collect()
    }

    /// The coordinates of a point in the plane.
    pub fn place(&self, point: &[f64]) -> [f64; 2] {
        let offsets = std::iter::zip(point, &self.mean).map(|(x, mean)| x - mean);
        let offsets: Vec<f64> = offsets.collect();
        self.axes.each_ref().map(|axis| dot(&offsets, axis))
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
        let plane = PrincipalPlane::new(&points).unwrap();
        assert!((plane.axes[0][2].abs() - 1.0).abs() < 1e-12, "{plane:?}");
        assert!((plane.axes[1][1].abs() - 1.0).abs() < 1e-12, "{plane:?}");
        assert!((plane.shares[0] / plane.shares[1] - 25.0).abs() < 1e-9);
        let [along, across] = plane.place(&[7.0, 2.0, 8.0]);
        assert!((along.abs() - 5.0).abs() < 1e-12 && across.abs() < 1e-12);
        let back = plane.point([along, across]);
        assert!((back[1] - 2.0).abs() < 1e-9 && (back[2] - 8.0).abs() < 1e-9);
        assert_eq!(PrincipalPlane::new(&points[..1]), None);
    }
}
