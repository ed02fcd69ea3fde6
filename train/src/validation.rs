//! Errors of a surrogate on rows held out, measured with the kernel that will be shipped.

use crate::config::TrainingConfig;
use crate::samples::Scales;
use dataset::Row;
use surrogate::{FitError, Order, Surrogate, TestErrors};

/// One number as the finite elements give it and as the surrogate does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParityPoint {
    pub target: f64,
    pub predicted: f64,
}

/// Targets and predictions of every row, in the order of the rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parity {
    /// W (N mm)
    pub energy: Vec<ParityPoint>,
    /// F_a (N)
    pub f_a: Vec<ParityPoint>,
    /// F_s (N)
    pub f_s: Vec<ParityPoint>,
    /// M_theta (N mm)
    pub m_theta: Vec<ParityPoint>,
    pub damage: Vec<ParityPoint>,
}

impl Parity {
    /// Evaluates the surrogate at every row.
    pub fn of(surrogate: &Surrogate, rows: &[Row]) -> Self {
        let designs: Vec<_> = rows.iter().map(|row| row.design).collect();
        let deformations: Vec<_> = rows.iter().map(|row| row.sample.deformation()).collect();
        let prepared = surrogate.prepare(&designs);
        let energies = surrogate.evaluate(&prepared, &deformations, Order::Forces);
        let damages = surrogate.damage(&designs, &deformations);
        let mut parity = Self::default();
        for ((row, energy), damage) in rows.iter().zip(energies).zip(damages) {
            let target = row.sample;
            let pairs = [
                (&mut parity.energy, target.w, energy.w),
                (&mut parity.f_a, target.f_a, energy.forces[0]),
                (&mut parity.f_s, target.f_s, energy.forces[1]),
                (&mut parity.m_theta, target.m_theta, energy.forces[2]),
                (&mut parity.damage, target.d, damage.d),
            ];
            for (points, target, predicted) in pairs {
                points.push(ParityPoint { target, predicted });
            }
        }
        parity
    }

    /// The errors by quantity.
    pub fn errors(&self) -> TestErrors {
        TestErrors {
            rows: self.energy.len(),
            energy: fit_error(&self.energy),
            f_a: fit_error(&self.f_a),
            f_s: fit_error(&self.f_s),
            m_theta: fit_error(&self.m_theta),
            damage: fit_error(&self.damage),
        }
    }

    /// The loss (15), in the scales of the training rows.
    pub(crate) fn loss(&self, scales: &Scales, config: &TrainingConfig) -> f64 {
        let [f_a, f_s, m_theta] = scales.forces;
        let force_weight = (1.0 - config.energy_weight) / 3.0;
        [
            (&self.energy, scales.energy, config.energy_weight),
            (&self.f_a, f_a, force_weight),
            (&self.f_s, f_s, force_weight),
            (&self.m_theta, m_theta, force_weight),
            (&self.damage, scales.damage, config.damage_weight),
        ]
        .into_iter()
        .map(|(points, scale, weight)| weight * (rms_error(points) / scale).powi(2))
        .sum()
    }
}

fn root_mean_square(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    (values.map(|value| value * value).sum::<f64>() / count).sqrt()
}

fn rms_error(points: &[ParityPoint]) -> f64 {
    root_mean_square(points.iter().map(|point| point.predicted - point.target))
}

/// Relative to the targets; an error of zero where every target is zero and so predicted.
fn fit_error(points: &[ParityPoint]) -> FitError {
    let target = root_mean_square(points.iter().map(|point| point.target));
    let nonzero = points.iter().filter(|point| point.target != 0.0);
    let mut relative: Vec<f64> = nonzero
        .map(|point| ((point.predicted - point.target) / point.target).abs())
        .collect();
    relative.sort_by(f64::total_cmp);
    FitError {
        relative_rmse: if target > 0.0 {
            rms_error(points) / target
        } else {
            0.0
        },
        median: relative.get(relative.len() / 2).copied().unwrap_or(0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_relative_to_the_targets() {
        let points = [(0.0, 0.3), (3.0, 3.3), (-4.0, -4.0), (5.0, 4.0)]
            .map(|(target, predicted)| ParityPoint { target, predicted });
        let error = fit_error(&points);
        let expected = ((0.09 + 0.09 + 1.0) / 50.0_f64).sqrt();
        assert!((error.relative_rmse - expected).abs() < 1e-12);
        assert!((error.median - 0.1).abs() < 1e-12);
    }
}
