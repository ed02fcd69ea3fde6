//! Smooth maximum and minimum: the softmax-weighted mean
//!
//! ```text
//! max^tau x = sum_i x_i e^(x_i/tau) / sum_i e^(x_i/tau),     min^tau x = -max^tau(-x)
//! ```
//!
//! which lies within the range of the values. tau = 0 gives the hard extremum.

use support::Extremes;

/// max^tau and its gradient; (0, []) for no values.
pub fn smooth_max(values: &[f64], temperature: f64) -> (f64, Vec<f64>) {
    let Some((index, &max)) = (values.iter().enumerate()).largest_by(|(_, value)| **value) else {
        return (0.0, Vec::new());
    };
    if temperature <= 0.0 {
        let mut gradient = vec![0.0; values.len()];
        gradient[index] = 1.0;
        return (max, gradient);
    }
    let mut weights: Vec<f64> =
        values.iter().map(|value| ((value - max) / temperature).exp()).collect();
    let total: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|weight| *weight /= total);
    let mean: f64 = std::iter::zip(values, &weights).map(|(x, p)| x * p).sum();
    let gradient = std::iter::zip(values, &weights)
        .map(|(x, p)| p * (1.0 + (x - mean) / temperature))
        .collect();
    (mean, gradient)
}

/// min^tau and its gradient.
pub fn smooth_min(values: &[f64], temperature: f64) -> (f64, Vec<f64>) {
    let mirrored: Vec<f64> = values.iter().map(|value| -value).collect();
    let (max, gradient) = smooth_max(&mirrored, temperature);
    (-max, gradient)
}

#[cfg(test)]
mod tests {
    use super::*;
    use testkit::derivatives::assert_gradient;

    const VALUES: [f64; 4] = [0.2, 0.9, -0.4, 0.85];

    #[test]
    fn gradients_agree_with_differences() {
        for extremum in [smooth_max, smooth_min] {
            let (_, gradient) = extremum(&VALUES, 0.1);
            assert_gradient(|x| extremum(x, 0.1).0, &VALUES, &gradient, 1e-6, |_| 1e-8);
        }
    }

    #[test]
    fn the_extremum_is_within_the_values_and_tends_to_the_hard_one() {
        let (mean, _) = smooth_max(&VALUES, 1e9);
        assert!((mean - 0.3875).abs() < 1e-8);
        assert!((smooth_max(&VALUES, 1e-4).0 - 0.9).abs() < 1e-15);
        assert_eq!(smooth_max(&VALUES, 0.0), (0.9, vec![0.0, 1.0, 0.0, 0.0]));
        assert_eq!(smooth_min(&VALUES, 0.0).0, -0.4);
        let huge = smooth_max(&[1e300, -1e300], 1e-3);
        assert_eq!(huge, (1e300, vec![1.0, 0.0]));
    }
}
