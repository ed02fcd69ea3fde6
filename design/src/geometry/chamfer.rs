//! The bidirectional Chamfer distance between the deployed outline P and the target T; below (16):
//!
//! ```text
//! 1/|P| sum_p min_t |p - t|^2  +  w_cov 1/|T| sum_t min_p |t - p|^2
//! ```
//!
//! A hard minimum has a kink where the nearest neighbour changes; `smoothing` > 0 uses min^tau. With
//! [`Precision::Samples`] the first sum attracts outline points to the samples of the target; with
//! [`Precision::Curve`] to the closed curve through the samples.

use crate::geometry::polygon::nearest_on_outline;
use crate::geometry::smooth_extrema::smooth_min;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What the distance of outline points in the first sum is measured to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    /// The nearest sample of the target, as in the paper.
    #[default]
    Samples,
    /// The closed curve through the samples in their order.
    Curve,
}

/// Weight and smoothness of the Chamfer distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chamfer {
    /// w_cov (dimensionless).
    pub coverage_weight: f64,
    /// Temperature of the minimum (mm^2); 0 is the hard minimum of the paper.
    pub smoothing: f64,
    /// What the distance of outline points in the first sum is measured to.
    pub precision: Precision,
}

impl Chamfer {
    /// The distance (mm^2) and its gradient in `points`; neither `points` nor `target` may be empty.
    pub fn evaluate(&self, points: &[[f64; 2]], target: &[[f64; 2]]) -> (f64, Vec<[f64; 2]>) {
        let mut gradient = vec![[0.0; 2]; points.len()];
        let precision = 1.0 / points.len() as f64;
        let mut value = 0.0;
        for (&p, gradient) in std::iter::zip(points, &mut gradient) {
            value += precision
                * match self.precision {
                    Precision::Samples => self.nearest(p, target, |t, weight| {
                        pull(gradient, precision * weight, p, t.1)
                    }),
                    Precision::Curve => {
                        let foot = nearest_on_outline(p, target);
                        pull(gradient, precision, p, foot);
                        squared(p, foot)
                    }
                };
        }
        let coverage = self.coverage_weight / target.len() as f64;
        for &t in target {
            value += coverage
                * self.nearest(t, points, |(k, p), weight| {
                    pull(&mut gradient[k], coverage * weight, p, t)
                });
        }
        (value, gradient)
    }

    /// The matrix of second derivatives of the distance in each point, for the neighbours that the points have: a factor
    /// L of L L^T, by columns. Neighbours that move with a point, along the curve, do not pull it back.
    pub fn curvature_factors(
        &self,
        points: &[[f64; 2]],
        target: &[[f64; 2]],
    ) -> Vec<[[f64; 2]; 2]> {
        let precision = 2.0 / points.len() as f64;
        let coverage = 2.0 * self.coverage_weight / target.len() as f64;
        let mut covered = vec![0.0; points.len()];
        for &t in target {
            self.nearest(t, points, |(k, _), weight| covered[k] += coverage * weight);
        }
        let factors = std::iter::zip(points, covered).map(|(&p, covered)| {
            let normal = match self.precision {
                Precision::Samples => None,
                Precision::Curve => direction(p, nearest_on_outline(p, target)),
            };
            // Along n the curvature is that of both sums, across it that of the second.
            let (n, across) = match normal {
                Some(n) => (n, covered),
                None => ([1.0, 0.0], precision + covered),
            };
            let (along, across) = ((precision + covered).sqrt(), across.sqrt());
            [
                [along * n[0], along * n[1]],
                [-across * n[1], across * n[0]],
            ]
        });
        factors.collect()
    }

    /// The smallest squared distance to `others`; `found` is called for each of them with non-zero weight.
    fn nearest(
        &self,
        from: [f64; 2],
        others: &[[f64; 2]],
        mut found: impl FnMut((usize, [f64; 2]), f64),
    ) -> f64 {
        let distances: Vec<f64> = others.iter().map(|to| squared(from, *to)).collect();
        let (value, weights) = smooth_min(&distances, self.smoothing);
        for (k, &weight) in weights
            .iter()
            .enumerate()
            .filter(|(_, weight)| **weight != 0.0)
        {
            found((k, others[k]), weight);
        }
        value
    }
}

/// The unit vector from one point to another; `None` if they coincide.
fn direction(from: [f64; 2], to: [f64; 2]) -> Option<[f64; 2]> {
    let length = squared(from, to).sqrt();
    (length > 0.0).then(|| [0, 1].map(|axis| (to[axis] - from[axis]) / length))
}

fn squared(p: [f64; 2], q: [f64; 2]) -> f64 {
    (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2)
}

/// Adds the gradient of weight |p - t|^2 with respect to p.
fn pull(gradient: &mut [f64; 2], weight: f64, p: [f64; 2], t: [f64; 2]) {
    for axis in 0..2 {
        gradient[axis] += 2.0 * weight * (p[axis] - t[axis]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::taylor::central_slope;

    const POINTS: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.1], [0.4, 0.9]];
    const TARGET: [[f64; 2]; 2] = [[0.1, 0.0], [0.9, 0.8]];

    #[test]
    fn the_distance_of_two_small_sets_by_hand() {
        let chamfer = Chamfer {
            coverage_weight: 0.5,
            smoothing: 0.0,
            precision: Precision::Samples,
        };
        let on_samples = (0.01 + (0.01 + 0.49) + (0.25 + 0.01)) / 3.0;
        let coverage = (0.01 + (0.25 + 0.01)) / 2.0;
        let (value, _) = chamfer.evaluate(&POINTS, &TARGET);
        assert!((value - on_samples - 0.5 * coverage).abs() < 1e-15);
        // The first point is nearest to an end of the segment; the others are at the distances 0.8 and 0.6
        // divided by the square root of 2.
        let to_curve = Chamfer {
            precision: Precision::Curve,
            ..chamfer
        };
        let on_curve = (0.01 + 0.5 * 0.64 + 0.5 * 0.36) / 3.0;
        let (value, _) = to_curve.evaluate(&POINTS, &TARGET);
        assert!((value - on_curve - 0.5 * coverage).abs() < 1e-15, "{value}");
    }

    #[test]
    fn curvature_is_the_slope_of_the_gradient_while_neighbours_stay() {
        for precision in [Precision::Samples, Precision::Curve] {
            let chamfer = Chamfer {
                coverage_weight: 0.5,
                smoothing: 0.0,
                precision,
            };
            // The first point is nearest to an end of the curve, which does not move with it.
            for k in 1..3 {
                for way in [[1.0, 0.0], [0.6, 0.8]] {
                    let gradient = |step: f64| {
                        let mut points = POINTS;
                        (0..2).for_each(|axis| points[k][axis] += step * way[axis]);
                        let (_, gradient) = chamfer.evaluate(&points, &TARGET);
                        gradient[k][0] * way[0] + gradient[k][1] * way[1]
                    };
                    let slope = (gradient(1e-5) - gradient(-1e-5)) / 2e-5;
                    let columns = chamfer.curvature_factors(&POINTS, &TARGET)[k];
                    let along = columns.map(|[x, y]| x * way[0] + y * way[1]);
                    let curvature = along[0] * along[0] + along[1] * along[1];
                    assert!((curvature - slope).abs() < 1e-9, "{curvature} {slope}");
                }
            }
        }
    }

    #[test]
    fn gradients_agree_with_differences() {
        let choices = [
            (0.0, Precision::Samples),
            (0.3, Precision::Samples),
            (0.0, Precision::Curve),
        ];
        for (smoothing, precision) in choices {
            let chamfer = Chamfer {
                coverage_weight: 0.5,
                smoothing,
                precision,
            };
            let value = |x: &[f64]| {
                let points: Vec<[f64; 2]> = x.chunks(2).map(|p| [p[0], p[1]]).collect();
                chamfer.evaluate(&points, &TARGET).0
            };
            let (_, gradient) = chamfer.evaluate(&POINTS, &TARGET);
            for (i, found) in gradient.as_flattened().iter().enumerate() {
                let unit: Vec<f64> = (0..6).map(|j| f64::from(i == j)).collect();
                let slope = central_slope(value, POINTS.as_flattened(), &unit, 1e-6);
                assert!((found - slope).abs() < 1e-8, "{found} {slope}");
            }
        }
    }
}
