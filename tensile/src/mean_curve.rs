//! The mean hardening curve of several specimens.

use crate::fit::Statistic;
use crate::regression::interpolated;

/// Number of intervals of the mean curve; they grow linearly, because a curve bends most after
/// yield.
const INTERVALS: usize = 400;

/// The mean of curves [stress, strain] with increasing strain, over the strain from their starts up
/// to their mean end.
///
/// The stress at zero is the mean. From there the mean increment of the curves that reach an
/// interval is added, so that a specimen that breaks early leaves no jump.
pub(super) fn mean_curve(curves: &[&[[f64; 2]]]) -> Vec<[f64; 2]> {
    let length = |curve: &[[f64; 2]]| curve[curve.len() - 1][1] - curve[0][1];
    let end = Statistic::new(curves.iter().map(|curve| length(curve))).mean;
    let mut stress = Statistic::new(curves.iter().map(|curve| curve[0][0])).mean;
    let mut rows = vec![[stress, 0.0]];
    for interval in 1..=INTERVALS {
        let [before, strain] =
            [interval - 1, interval].map(|index| end * (index as f64 / INTERVALS as f64).powi(2));
        if strain > before {
            let at = |curve: &[[f64; 2]], strain| interpolated(curve, 0, curve[0][1] + strain);
            let reached = curves.iter().filter(|curve| length(curve) >= before);
            let increments = reached.map(|curve| at(curve, strain) - at(curve, before));
            stress += Statistic::new(increments).mean;
            rows.push([stress, strain]);
        }
    }
    rows
}
