//! Intersection over union of two outlines, from their common lengths along horizontal lines.

use crate::geometry::polygon::edges;

/// Number of lines over the height of both outlines; the relative error of the areas is about 1e-5.
pub const LINES: usize = 4000;

/// Area of the intersection of two closed polygons divided by that of their union; 0 if both are empty.
pub fn intersection_over_union(one: &[[f64; 2]], other: &[[f64; 2]]) -> f64 {
    let heights = || one.iter().chain(other).map(|point| point[1]);
    let low = heights().fold(f64::INFINITY, f64::min);
    let high = heights().fold(f64::NEG_INFINITY, f64::max);
    let (mut common, mut total) = (0.0, 0.0);
    for i in 0..LINES {
        let y = low + (high - low) * (i as f64 + 0.5) / LINES as f64;
        let (inside_one, inside_other) = (crossings(one, y), crossings(other, y));
        let shared = shared_length(&inside_one, &inside_other);
        common += shared;
        total += length(&inside_one) + length(&inside_other) - shared;
    }
    if total > 0.0 { common / total } else { 0.0 }
}

/// The intervals of a horizontal line inside a polygon (even-odd rule).
pub fn crossings(polygon: &[[f64; 2]], y: f64) -> Vec<[f64; 2]> {
    let mut xs: Vec<f64> = edges(polygon)
        .filter(|(p, q)| (p[1] <= y) != (q[1] <= y))
        .map(|(p, q)| p[0] + (q[0] - p[0]) * (y - p[1]) / (q[1] - p[1]))
        .collect();
    xs.sort_by(f64::total_cmp);
    xs.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
}

/// Sum of the lengths of intervals [from, to].
pub fn length(intervals: &[[f64; 2]]) -> f64 {
    intervals.iter().map(|[from, to]| to - from).sum()
}

fn shared_length(one: &[[f64; 2]], other: &[[f64; 2]]) -> f64 {
    let pairs = one.iter().flat_map(|a| other.iter().map(move |b| (a, b)));
    pairs
        .map(|(a, b)| (a[1].min(b[1]) - a[0].max(b[0])).max(0.0))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shifted_squares_and_a_notched_one() {
        let square = |x: f64| vec![[x, 0.0], [x + 1.0, 0.0], [x + 1.0, 1.0], [x, 1.0]];
        assert_eq!(intersection_over_union(&square(0.0), &square(0.0)), 1.0);
        assert_eq!(intersection_over_union(&square(0.0), &square(2.0)), 0.0);
        let third = intersection_over_union(&square(0.0), &square(0.5));
        assert!((third - 1.0 / 3.0).abs() < 1e-12, "{third}");
        let notched = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.5, 0.5], [0.0, 1.0]];
        let ratio = intersection_over_union(&notched, &square(0.0));
        assert!((ratio - 0.75).abs() < 1e-5, "{ratio}");
    }
}
