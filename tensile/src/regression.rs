//! The straight line through rows [x, y], by least squares, and linear interpolation between them.

use std::ops::Range;
use support::interpolation::piece;
use support::{Extremes, Point};

/// The line through a set of rows.
pub(super) struct Regression {
    /// Means of x and y.
    pub mean: Point,
    /// Sum of the squared deviations of x from its mean.
    pub squares: f64,
    /// Slope of the line; not finite if all x are equal.
    pub slope: f64,
    /// Standard error of the slope, from the distances of the rows to the line; not a number for
    /// two rows.
    pub error: f64,
}

impl Regression {
    pub(crate) fn new(rows: &[Point]) -> Self {
        let mean = mean(rows);
        let (mut squares, mut products, mut total) = (0.0, 0.0, 0.0);
        for row in rows {
            let [x, y] = [0, 1].map(|of| row[of] - mean[of]);
            squares += x * x;
            products += x * y;
            total += y * y;
        }
        let slope = products / squares;
        let left = (total - slope * products).max(0.0);
        Self { mean, squares, slope, error: (left / (rows.len() as f64 - 2.0) / squares).sqrt() }
    }
}

/// The mean of rows.
pub(super) fn mean(rows: &[Point]) -> Point {
    [0, 1].map(|of| rows.iter().map(|row| row[of]).sum::<f64>() / rows.len() as f64)
}

/// The value in the column `of` of a curve at the value `x` in its other column, which increases:
/// linear between rows, constant beyond the ends.
pub(super) fn interpolated(curve: &[Point], of: usize, x: f64) -> f64 {
    let (low, high, fraction) = piece(curve, |row| row[1 - of], x);
    low[of] + (high[of] - low[of]) * fraction
}

// Isotonic regression: the closest increasing sequence in the sense of least squares (pool
// adjacent violators).

/// The index ranges over which a sequence is averaged to make it non-decreasing, or increasing if
/// `strict`.
pub(super) fn pools(values: impl Iterator<Item = f64>, strict: bool) -> Vec<Range<usize>> {
    let mut pools: Vec<(Range<usize>, f64)> = Vec::new();
    for (index, value) in values.enumerate() {
        let (mut range, mut sum) = (index..index + 1, value);
        while let Some((before, other)) = pools.last() {
            let (mean, previous) = (sum / range.len() as f64, other / before.len() as f64);
            if mean > previous || (mean == previous && !strict) {
                break;
            }
            (range.start, sum) = (before.start, sum + other);
            pools.pop();
        }
        pools.push((range, sum));
    }
    pools.into_iter().map(|(range, _)| range).collect()
}

/// The sequence with the values of each pool replaced by their mean.
pub(super) fn non_decreasing(values: &[f64]) -> Vec<f64> {
    let pools = pools(values.iter().copied(), false);
    let means = pools.into_iter().flat_map(|range| {
        let count = range.len();
        let mean = values[range].iter().sum::<f64>() / count as f64;
        std::iter::repeat_n(mean, count)
    });
    means.collect()
}

// A curve reduced to the rows from which linear interpolation reproduces it.

/// Relative deviation that no row improves.
pub(super) const TOLERANCE: f64 = 1e-3;

/// The indices of at most `most` rows (at least 2) of a curve [stress, strain], and the maximum
/// deviation of the interpolated stress over the stress. The row with the largest deviation is
/// added until none exceeds [`TOLERANCE`].
pub(super) fn thinned(curve: &[Point], most: usize) -> (Vec<usize>, f64) {
    let mut kept = vec![0, curve.len() - 1];
    kept.dedup();
    loop {
        let between = kept.windows(2).flat_map(|pair| {
            let ends = [pair[0], pair[1]].map(|row| curve[row]);
            (pair[0] + 1..pair[1]).map(move |row| {
                let [stress, strain] = curve[row];
                ((interpolated(&ends, 0, strain) / stress - 1.0).abs(), row)
            })
        });
        match between.largest_by(|(deviation, _)| *deviation) {
            Some((deviation, row)) if deviation > TOLERANCE && kept.len() < most => {
                kept.push(row);
                kept.sort_unstable();
            }
            worst => return (kept, worst.map_or(0.0, |(deviation, _)| deviation)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn violators_are_averaged_and_an_increasing_sequence_is_unchanged() {
        assert_eq!(non_decreasing(&[1.0, 2.0, 2.0, 5.0]), [1.0, 2.0, 2.0, 5.0]);
        assert_eq!(non_decreasing(&[1.0, 4.0, 2.0, 6.0]), [1.0, 3.0, 3.0, 6.0]);
        assert_eq!(non_decreasing(&[3.0, 2.0, 1.0]), [2.0; 3]);
        assert_eq!(pools([1.0, 1.0, 2.0].into_iter(), true), [0..2, 2..3]);
        assert_eq!(pools([1.0, 1.0, 2.0].into_iter(), false).len(), 3);
    }
}

#[cfg(test)]
mod thinning_tests {
    use super::*;

    #[test]
    fn the_stated_deviation_holds_and_corners_are_kept() {
        let voce = |strain: f64| 100.0 + 80.0 * (1.0 - (-strain / 0.05).exp());
        let curve: Vec<[f64; 2]> =
            (0..=1000).map(|i| 3e-4 * f64::from(i)).map(|strain| [voce(strain), strain]).collect();
        let mut deviations = Vec::new();
        for most in [5, 10, 100] {
            let (kept, deviation) = thinned(&curve, most);
            assert!(kept.len() <= most && kept[0] == 0 && kept[kept.len() - 1] == 1000);
            let rows: Vec<[f64; 2]> = kept.iter().map(|row| curve[*row]).collect();
            for [stress, strain] in &curve {
                let found = (interpolated(&rows, 0, *strain) / stress - 1.0).abs();
                assert!(found <= deviation + 1e-12);
            }
            deviations.push(deviation);
        }
        assert!(deviations[0] > deviations[1] && deviations[2] <= TOLERANCE);
        let bilinear: Vec<[f64; 2]> =
            (0..=100).map(|i| [50.0 + f64::from((i - 40).max(0)), f64::from(i)]).collect();
        assert_eq!(thinned(&bilinear, 30), (vec![0, 40, 100], 0.0));
        assert_eq!(thinned(&bilinear[..1], 30), (vec![0], 0.0));
    }
}
