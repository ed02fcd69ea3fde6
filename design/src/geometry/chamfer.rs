//! The bidirectional Chamfer distance between the deployed outline P and the target T; below (16):
//!
//! ```text
//! 1/|P| sum_p min_t |p - t|^2  +  w_cov 1/|T| sum_t min_p |t - p|^2
//! ```
//!
//! The first sum attracts outline points to the closed curve through the samples of the target,
//! where the paper takes the nearest sample: the difference is at most a quarter of the squared
//! spacing of the samples.

use crate::geometry::polygon::nearest_on_outline;
use support::{Extremes, Point};

/// The distance (mm^2) with the weight w_cov of the second sum, and its gradient in `points`;
/// neither `points` nor `target` may be empty.
pub fn chamfer(points: &[Point], target: &[Point], coverage_weight: f64) -> (f64, Vec<Point>) {
    let mut gradient = vec![[0.0; 2]; points.len()];
    let precision = 1.0 / points.len() as f64;
    let mut value = 0.0;
    for (&p, gradient) in std::iter::zip(points, &mut gradient) {
        let foot = nearest_on_outline(p, target);
        pull(gradient, precision, p, foot);
        value += precision * squared(p, foot);
    }
    let coverage = coverage_weight / target.len() as f64;
    for &t in target {
        let distances = points.iter().map(|p| squared(*p, t)).enumerate();
        if let Some((k, distance)) = distances.smallest_by(|(_, distance)| *distance) {
            pull(&mut gradient[k], coverage, points[k], t);
            value += coverage * distance;
        }
    }
    (value, gradient)
}

fn squared(p: Point, q: Point) -> f64 {
    (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2)
}

/// Adds the gradient of weight |p - t|^2 with respect to p.
fn pull(gradient: &mut Point, weight: f64, p: Point, t: Point) {
    for axis in 0..2 {
        gradient[axis] += 2.0 * weight * (p[axis] - t[axis]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;
    use testkit::derivatives::{assert_close, assert_gradient};

    const POINTS: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.1], [0.4, 0.9]];
    const TARGET: [[f64; 2]; 2] = [[0.1, 0.0], [0.9, 0.8]];

    #[test]
    fn the_distance_of_two_small_sets_by_hand() {
        // The first point is nearest to an end of the segment; the others are at the distances 0.8
        // and 0.6 divided by the square root of 2.
        let on_curve = (0.01 + 0.5 * 0.64 + 0.5 * 0.36) / 3.0;
        let coverage = (0.01 + (0.25 + 0.01)) / 2.0;
        let (value, _) = chamfer(&POINTS, &TARGET, 0.5);
        assert_close(value, on_curve + 0.5 * coverage, 1e-15);
    }

    /// The paper measures the first sum to the samples of the target: with many samples it is that
    /// to the curve.
    #[test]
    fn the_samples_of_the_paper_are_the_limit_of_many() {
        let circle = |n: usize| -> Vec<[f64; 2]> {
            let angle = |i: usize| TAU * i as f64 / n as f64;
            (0..n).map(|i| [angle(i).cos(), angle(i).sin()]).collect()
        };
        let to_samples = |target: &[[f64; 2]]| {
            let nearest = |p: &[f64; 2]| {
                let distances = target.iter().map(|t| squared(*p, *t));
                distances.fold(f64::INFINITY, f64::min)
            };
            POINTS.iter().map(nearest).sum::<f64>() / POINTS.len() as f64
        };
        for n in [100, 1000] {
            let target = circle(n);
            let (to_curve, _) = chamfer(&POINTS, &target, 0.0);
            let excess = to_samples(&target) - to_curve;
            let most = 0.25 * (TAU / n as f64).powi(2);
            assert!((0.0..=most).contains(&excess), "{excess}");
        }
    }

    #[test]
    fn the_gradient_agrees_with_differences() {
        let value = |x: &[f64]| chamfer(x.as_chunks().0, &TARGET, 0.5).0;
        let (_, gradient) = chamfer(&POINTS, &TARGET, 0.5);
        let (points, slopes) = (POINTS.as_flattened(), gradient.as_flattened());
        assert_gradient(value, points, slopes, 1e-6, |_| 1e-8);
    }
}
