//! The spread of networks with different seeds as a measure of their error.
//!
//! ```text
//! deviation^2 = mean over members and force components of |F_m,c - mean_m F_c|^2 / sigma_c^2
//! error^2     = mean over force components of |mean_m F_c - F_c*|^2 / sigma_c^2
//! ```

use dataset::Row;
use support::statistics::root_mean_square;
use surrogate::{Order, Surrogate};

/// Deviation of the members' forces at one state, and their error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disagreement {
    /// Deviation of the members from their mean.
    pub deviation: f64,
    /// Error of the members' mean.
    pub error: f64,
}

/// How well the deviation of the members predicts their error, over many states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnsembleCheck {
    /// Root mean square of the deviation.
    pub deviation: f64,
    /// Root mean square of the error.
    pub error: f64,
    /// Fraction of the squared error on the tenth of the states with the largest deviation; it is one tenth
    /// if deviation and error are independent.
    pub error_in_top_tenth: f64,
    /// Correlation of the logarithms of deviation and error.
    pub correlation: f64,
}

/// Deviation and error at each row; sigma_c is the root mean square of a force component over all rows.
///
/// `members` must not be empty.
pub fn disagreements(members: &[Surrogate], rows: &[Row]) -> Vec<Disagreement> {
    let forces: Vec<Vec<[f64; 3]>> = members.iter().map(|member| forces(member, rows)).collect();
    let targets: Vec<[f64; 3]> = rows
        .iter()
        .map(|row| [row.sample.f_a, row.sample.f_s, row.sample.m_theta])
        .collect();
    let scales = [0, 1, 2].map(|c| root_mean_square(targets.iter().map(|f| f[c])));
    let count = members.len() as f64;
    let of_row = |row: usize| {
        let [mut deviation, mut error] = [0.0; 2];
        for (c, scale) in scales.into_iter().enumerate() {
            let mean = forces.iter().map(|member| member[row][c]).sum::<f64>() / count;
            let square = |value: f64| ((value - mean) / scale).powi(2);
            let squares = forces.iter().map(|member| square(member[row][c]));
            deviation += squares.sum::<f64>() / count / 3.0;
            error += square(targets[row][c]) / 3.0;
        }
        Disagreement {
            deviation: deviation.sqrt(),
            error: error.sqrt(),
        }
    };
    (0..rows.len()).map(of_row).collect()
}

impl EnsembleCheck {
    /// Evaluates the states, of which there must be at least one.
    pub fn new(states: &[Disagreement]) -> Self {
        let logarithm = |value: f64| value.max(f64::MIN_POSITIVE).ln();
        let pairs = states.iter();
        let pairs = pairs.map(|state| (logarithm(state.deviation), logarithm(state.error)));
        let correlation = correlation(pairs);
        let mut sorted = states.to_vec();
        sorted.sort_by(|left, right| right.deviation.total_cmp(&left.deviation));
        let squared_error =
            |states: &[Disagreement]| states.iter().map(|state| state.error.powi(2)).sum::<f64>();
        let top = &sorted[..states.len().div_ceil(10)];
        Self {
            deviation: root_mean_square(states.iter().map(|state| state.deviation)),
            error: root_mean_square(states.iter().map(|state| state.error)),
            error_in_top_tenth: squared_error(top) / squared_error(states),
            correlation,
        }
    }
}

/// Pearson's correlation coefficient; zero if one of the quantities is constant.
fn correlation(pairs: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
    let mean = |value: fn((f64, f64)) -> f64| {
        let (count, sum) = pairs
            .clone()
            .fold((0.0, 0.0), |(n, sum), pair| (n + 1.0, sum + value(pair)));
        sum / count
    };
    let (x, y) = (mean(|pair| pair.0), mean(|pair| pair.1));
    let covariance = mean(|(x, y)| x * y) - x * y;
    let variances = (mean(|(x, _)| x * x) - x * x) * (mean(|(_, y)| y * y) - y * y);
    if variances > 0.0 {
        covariance / variances.sqrt()
    } else {
        0.0
    }
}

fn forces(surrogate: &Surrogate, rows: &[Row]) -> Vec<[f64; 3]> {
    let (designs, states): (Vec<_>, Vec<_>) = rows
        .iter()
        .map(|row| (row.design, row.sample.deformation()))
        .unzip();
    let prepared = surrogate.prepare(&designs);
    let energies = surrogate.evaluate(&prepared, &states, Order::Forces);
    energies.iter().map(|energy| energy.forces).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correlation_is_one_on_a_line_and_zero_of_a_constant() {
        let line = [1.0, 2.0, 4.0].map(|x| (x, 3.0 * x - 1.0));
        assert!((correlation(line.into_iter()) - 1.0).abs() < 1e-12);
        let falling = line.map(|(x, y)| (x, -y));
        assert!((correlation(falling.into_iter()) + 1.0).abs() < 1e-12);
        assert_eq!(correlation(line.map(|(x, _)| (x, 5.0)).into_iter()), 0.0);
    }

    #[test]
    fn a_deviation_in_proportion_to_the_error_has_correlation_one() {
        let states: Vec<_> = (1..=20)
            .map(|k| Disagreement {
                deviation: 0.5 * f64::from(k),
                error: f64::from(k),
            })
            .collect();
        let check = EnsembleCheck::new(&states);
        assert!((check.error - 2.0 * check.deviation).abs() < 1e-12);
        assert!((check.correlation - 1.0).abs() < 1e-12);
        let share = (19.0 * 19.0 + 20.0 * 20.0) / 2870.0;
        assert!((check.error_in_top_tenth - share).abs() < 1e-12);
    }
}
