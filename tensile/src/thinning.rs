//! A curve reduced to the rows from which linear interpolation reproduces it.

/// Relative deviation that no row improves.
pub(super) const TOLERANCE: f64 = 1e-3;

/// The indices of at most `most` rows (at least 2) of a curve [stress, strain], and the maximum
/// deviation of the interpolated stress over the stress. The row with the largest deviation is
/// added until none exceeds [`TOLERANCE`].
pub(super) fn thinned(curve: &[[f64; 2]], most: usize) -> (Vec<usize>, f64) {
    let mut kept = vec![0];
    kept.extend((curve.len() > 1).then(|| curve.len() - 1));
    loop {
        let worst = (kept.windows(2))
            .filter_map(|pair| farthest(curve, pair[0], pair[1]))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        match worst {
            Some((deviation, row)) if deviation > TOLERANCE && kept.len() < most => {
                let place = kept.partition_point(|other| *other < row);
                kept.insert(place, row);
            }
            worst => return (kept, worst.map_or(0.0, |(deviation, _)| deviation)),
        }
    }
}

/// The row between two others that deviates most from the line through them, with its relative
/// deviation.
fn farthest(curve: &[[f64; 2]], first: usize, last: usize) -> Option<(f64, usize)> {
    let ([s0, e0], [s1, e1]) = (curve[first], curve[last]);
    let deviation = |row: usize| {
        let [stress, strain] = curve[row];
        let line = s0 + (s1 - s0) * (strain - e0) / (e1 - e0);
        (((line - stress) / stress).abs(), row)
    };
    (first + 1..last).map(deviation).max_by(|a, b| a.0.total_cmp(&b.0))
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
            for pair in kept.windows(2) {
                let found =
                    farthest(&curve, pair[0], pair[1]).map_or(0.0, |(deviation, _)| deviation);
                assert!(found <= deviation);
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
