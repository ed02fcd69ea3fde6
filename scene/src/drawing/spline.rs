//! Splines, approximated by segments.

use crate::drawing::contour::flatten;
use design::geometry::plane::point;
use faer::c64;
use support::Point;

/// Number of segments of a spline between two knots.
const SEGMENTS: usize = 32;
/// Iterations for the tangents of a spline through points, whose error each one halves or better.
const SWEEPS: usize = 60;

/// Points on a cubic spline through points (not repeated): its curvature is continuous, and zero at
/// open ends, if the parameter is the length of the chords. Its tangents are found by Gauss-Seidel
/// iterations.
pub(super) fn through(points: &[c64], closed: bool) -> Vec<Point> {
    let n = points.len();
    let sides = |i: usize| {
        let before = (closed || i > 0).then_some((i + n - 1) % n);
        let after = (closed || i + 1 < n).then_some((i + 1) % n);
        [(before, -1.0), (after, 1.0)].into_iter().filter_map(|(j, sign)| Some((j?, sign)))
    };
    let mut tangents = vec![c64::new(0.0, 0.0); n];
    for _ in 0..SWEEPS {
        for i in 0..n {
            let (mut sum, mut weights) = (c64::new(0.0, 0.0), 0.0);
            for (j, sign) in sides(i) {
                let chord = sign * (points[j] - points[i]);
                let weight = 1.0 / chord.norm();
                sum += weight * (3.0 * weight * chord - tangents[j]);
                weights += 2.0 * weight;
            }
            tangents[i] = sum / weights;
        }
    }
    let mut found = vec![point(points[0])];
    for i in 0..n - usize::from(!closed) {
        let j = (i + 1) % n;
        let third = (points[j] - points[i]).norm() / 3.0;
        let [b, c] = [points[i] + third * tangents[i], points[j] - third * tangents[j]];
        flatten(&mut found, &[b, c, points[j]].map(point));
    }
    found
}

/// Points on a B-spline (de Boor), rational if its control points have weights.
pub(super) fn b_spline(
    degree: usize,
    knots: &[f64],
    points: &[Point],
    weights: &[f64],
) -> Vec<Point> {
    let controls = points.iter().enumerate().map(|(i, [x, y])| {
        let weight = weights.get(i).copied().unwrap_or(1.0);
        [x * weight, y * weight, weight]
    });
    let controls: Vec<[f64; 3]> = controls.collect();
    let at = |span: usize, t: f64| {
        let mut level = controls[span - degree..=span].to_vec();
        for round in 1..=degree {
            for j in (round..=degree).rev() {
                let i = span - degree + j;
                let part = (t - knots[i]) / (knots[i + 1 + degree - round] - knots[i]);
                let before = level[j - 1];
                (0..3).for_each(|c| level[j][c] = (1.0 - part) * before[c] + part * level[j][c]);
            }
        }
        let [x, y, weight] = level[degree];
        [x / weight, y / weight]
    };
    let mut found = Vec::new();
    for span in (degree..points.len()).filter(|span| knots[span + 1] > knots[*span]) {
        let [from, to] = [knots[span], knots[span + 1]];
        let t = |i: usize| from + (to - from) * i as f64 / SEGMENTS as f64;
        found.extend((0..=SEGMENTS).map(|i| at(span, t(i))));
    }
    found
}
