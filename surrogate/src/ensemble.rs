//! Agreement of several networks of the same training.

/// Mean and variance of one quantity over the networks of an ensemble, without bias: the sum of
/// squares is divided by n - 1. The variance of a single value is 0.
pub fn mean_and_variance(values: impl IntoIterator<Item = f64, IntoIter: Clone>) -> [f64; 2] {
    let values = values.into_iter();
    let n = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / n;
    let squares: f64 = values.map(|value| (value - mean).powi(2)).sum();
    [mean, squares / (n - 1.0).max(1.0)]
}

#[cfg(test)]
mod tests {
    use super::mean_and_variance;

    #[test]
    fn the_variance_is_without_bias_and_zero_for_one_value() {
        let [mean, variance] = mean_and_variance([0.9, 1.0, 1.1]);
        assert!((mean - 1.0).abs() < 1e-15 && (variance - 0.01).abs() < 1e-15);
        assert_eq!(mean_and_variance([3.0]), [3.0, 0.0]);
        assert!(mean_and_variance([1.0, f64::NAN])[1].is_nan());
    }
}
