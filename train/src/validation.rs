//! Errors of a surrogate on rows that are not used in training, measured with the exported float64 networks.

use crate::config::TrainingConfig;
use crate::samples::Scales;
use dataset::Row;
use surrogate::{FitError, Surrogate, TestErrors};

/// One value of the finite elements and of the surrogate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParityPoint {
    /// Value of the finite elements; NaN if it is unknown.
    pub target: f64,
    /// Value of the surrogate.
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
    /// D
    pub damage: Vec<ParityPoint>,
    /// D_peak; empty if the surrogate does not predict it.
    pub damage_peak: Vec<ParityPoint>,
}

impl Parity {
    /// Evaluates the surrogate at every row.
    pub fn of(surrogate: &Surrogate, rows: &[Row]) -> Self {
        let (designs, deformations): (Vec<_>, Vec<_>) = rows
            .iter()
            .map(|row| (row.design, row.sample.deformation()))
            .unzip();
        let mut parity = Self::default();
        for (row, found) in rows.iter().zip(surrogate.samples(&designs, &deformations)) {
            let target = row.sample;
            let pairs = [
                (&mut parity.energy, target.w, Some(found.w)),
                (&mut parity.f_a, target.f_a, Some(found.f_a)),
                (&mut parity.f_s, target.f_s, Some(found.f_s)),
                (&mut parity.m_theta, target.m_theta, Some(found.m_theta)),
                (&mut parity.damage, target.d, Some(found.d)),
                (
                    &mut parity.damage_peak,
                    target.d_peak.unwrap_or(f64::NAN),
                    found.d_peak,
                ),
            ];
            for (points, target, predicted) in pairs {
                points.extend(predicted.map(|predicted| ParityPoint { target, predicted }));
            }
        }
        parity
    }

    /// The mean of the predictions of several surrogates for the same rows.
    pub fn mean(members: &[Self]) -> Self {
        let mean = |points: fn(&Self) -> &[ParityPoint]| {
            let count = members.len() as f64;
            let of_row = |row: usize, target: f64| ParityPoint {
                target,
                predicted: members
                    .iter()
                    .map(|it| points(it)[row].predicted)
                    .sum::<f64>()
                    / count,
            };
            let targets = members.iter().take(1).flat_map(points).enumerate();
            targets
                .map(|(row, point)| of_row(row, point.target))
                .collect()
        };
        Self {
            energy: mean(|it| &it.energy),
            f_a: mean(|it| &it.f_a),
            f_s: mean(|it| &it.f_s),
            m_theta: mean(|it| &it.m_theta),
            damage: mean(|it| &it.damage),
            damage_peak: mean(|it| &it.damage_peak),
        }
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
            damage_peak: fit_error(&self.damage_peak),
        }
    }

    /// The targets and predictions of the rows with these indices.
    pub(crate) fn of_rows(&self, indices: &[usize]) -> Self {
        let some = |points: &[ParityPoint]| {
            let chosen = indices.iter().filter_map(|&index| points.get(index));
            chosen.copied().collect()
        };
        Self {
            energy: some(&self.energy),
            f_a: some(&self.f_a),
            f_s: some(&self.f_s),
            m_theta: some(&self.m_theta),
            damage: some(&self.damage),
            damage_peak: some(&self.damage_peak),
        }
    }

    /// The loss (15) in the scales of the training rows.
    pub(crate) fn loss(&self, scales: &Scales, config: &TrainingConfig) -> f64 {
        let [f_a, f_s, m_theta] = scales.forces;
        let force_weight = (1.0 - config.energy_weight) / 3.0;
        let damages = 1 + usize::from(scales.peak.is_some());
        let damage_weight = config.damage_weight / damages as f64;
        [
            (&self.energy, scales.energy, config.energy_weight),
            (&self.f_a, f_a, force_weight),
            (&self.f_s, f_s, force_weight),
            (&self.m_theta, m_theta, force_weight),
            (&self.damage, scales.damage, damage_weight),
        ]
        .into_iter()
        .chain(
            scales
                .peak
                .map(|scale| (&self.damage_peak, scale, damage_weight)),
        )
        .map(|(points, scale, weight)| weight * (rms_error(points) / scale).powi(2))
        .sum()
    }

    /// The relative root mean square error of each network, by which its best epoch is chosen: the geometric mean of
    /// the known errors of W and the forces; the error of D; and the error of D_peak. NaN if it is not known. The
    /// geometric mean prevents a few states of large force, which dominate the loss, from determining the choice. The
    /// error of each state is limited to the root mean square of its quantity, so that a single ray far from all
    /// training rays does not determine the choice.
    pub(crate) fn network_errors(&self) -> [f64; 3] {
        let potential = [&self.energy, &self.f_a, &self.f_s, &self.m_theta];
        let potential = potential.map(|points| limited_error(points));
        let known: Vec<f64> = potential.into_iter().filter(|it| !it.is_nan()).collect();
        let mean = match known.len() {
            0 => f64::NAN,
            count => known.iter().product::<f64>().powf(1.0 / count as f64),
        };
        [
            mean,
            limited_error(&self.damage),
            limited_error(&self.damage_peak),
        ]
    }
}

/// The root mean square error divided by the root mean square of the targets, each error being limited to the latter; NaN
/// if no target is known, or all are zero.
fn limited_error(points: &[ParityPoint]) -> f64 {
    let targets: Vec<f64> = known(points).map(|point| point.target).collect();
    let target = root_mean_square(targets.into_iter());
    let errors = known(points).map(|point| (point.predicted - point.target).abs().min(target));
    let errors: Vec<f64> = errors.collect();
    if target > 0.0 {
        root_mean_square(errors.into_iter()) / target
    } else {
        f64::NAN
    }
}

/// Root mean square of the values; zero if there are none.
pub(crate) fn root_mean_square(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len().max(1) as f64;
    (values.map(|value| value * value).sum::<f64>() / count).sqrt()
}

fn rms_error(points: &[ParityPoint]) -> f64 {
    let known: Vec<f64> = known(points)
        .map(|point| point.predicted - point.target)
        .collect();
    root_mean_square(known.into_iter())
}

/// The points whose target is known.
fn known(points: &[ParityPoint]) -> impl Iterator<Item = &ParityPoint> {
    points.iter().filter(|point| !point.target.is_nan())
}

/// Errors relative to the targets; not known if no target is known, or all are zero.
pub(crate) fn fit_error(points: &[ParityPoint]) -> FitError {
    let targets: Vec<f64> = known(points).map(|point| point.target).collect();
    let target = root_mean_square(targets.into_iter());
    let nonzero = known(points).filter(|point| point.target != 0.0);
    let mut relative: Vec<f64> = nonzero
        .map(|point| ((point.predicted - point.target) / point.target).abs())
        .collect();
    relative.sort_by(f64::total_cmp);
    match relative.get(relative.len() / 2) {
        Some(&median) => FitError {
            relative_rmse: rms_error(points) / target,
            median,
        },
        None => FitError::unknown(),
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

    #[test]
    fn the_error_of_one_outlying_state_is_limited() {
        let point = |predicted| ParityPoint {
            target: 2.0,
            predicted,
        };
        let errors = [point(2.1), point(1.9), point(f64::INFINITY)];
        assert!((limited_error(&errors[..2]) - 0.05).abs() < 1e-12);
        assert!(
            (limited_error(&errors) - (0.0025 * 2.0 / 3.0 + 1.0 / 3.0_f64).sqrt()).abs() < 1e-12
        );
        let unknown = ParityPoint {
            target: f64::NAN,
            predicted: 1.0,
        };
        let zero = ParityPoint {
            target: 0.0,
            predicted: 1.0,
        };
        for points in [vec![], vec![unknown], vec![zero, unknown]] {
            assert!(limited_error(&points).is_nan());
            assert!(fit_error(&points).relative_rmse.is_nan());
            assert!(fit_error(&points).median.is_nan());
        }
        assert_eq!(
            fit_error(&[point(2.1), unknown]).relative_rmse,
            fit_error(&[point(2.1)]).relative_rmse
        );
    }
}
