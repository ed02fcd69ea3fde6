//! A curve reduced to the rows from which linear interpolation reproduces it.

use crate::regression::interpolated;

/// Relative deviation that no row improves.
pub(super) const TOLERANCE: f64 = 1e-3;

/// The indices of at most `most` rows (at least 2) of a curve [stress, strain], and the maximum
/// deviation of the interpolated stress over the stress. The row with the largest deviation is
/// added until none exceeds [`TOLERANCE`].
pub(super) fn thinned(curve: &[[f64; 2]], most: usize) -> (Vec<usize>, f64) {
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
        match between.max_by(|a, b| a.0.total_cmp(&b.0)) {
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
