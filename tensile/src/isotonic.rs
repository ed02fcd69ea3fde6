//! Isotonic regression: the closest increasing sequence in the sense of least squares (pool
//! adjacent violators).

use std::ops::Range;

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
