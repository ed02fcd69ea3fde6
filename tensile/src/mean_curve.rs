//! The mean hardening curve of several specimens.

use crate::regression::interpolated;

/// Number of intervals of the mean curve; they grow linearly, because a curve bends most after
/// yield.
const INTERVALS: usize = 400;

/// The mean of curves [stress, strain] with increasing strain that start at zero strain, up to the
/// strain `end`.
///
/// The stress at zero is the mean. From there the mean increment of the curves that reach an
/// interval is added, so that a specimen that breaks early leaves no jump.
pub(super) fn mean_curve(curves: &[&[[f64; 2]]], end: f64) -> Vec<[f64; 2]> {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let starts: Vec<f64> = curves.iter().map(|curve| interpolated(curve, 0, 0.0)).collect();
    let mut rows = vec![[mean(&starts), 0.0]];
    if end <= 0.0 {
        return rows;
    }
    for interval in 1..=INTERVALS {
        let [before, strain] =
            [interval - 1, interval].map(|index| end * (index as f64 / INTERVALS as f64).powi(2));
        let reached = |curve: &&&[[f64; 2]]| curve.last().is_some_and(|row| row[1] >= before);
        let increments: Vec<f64> = (curves.iter().filter(reached))
            .map(|curve| interpolated(curve, 0, strain) - interpolated(curve, 0, before))
            .collect();
        let increment = if increments.is_empty() { 0.0 } else { mean(&increments) };
        rows.push([rows[rows.len() - 1][0] + increment, strain]);
    }
    rows
}
