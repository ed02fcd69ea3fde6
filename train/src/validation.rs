//! Errors of a surrogate on rays that are not used in training, measured with the exported float64
//! networks.

use crate::config::{DAMAGE_WEIGHT, ENERGY_WEIGHT};
use crate::samples::Scales;
use dataset::{ComparedState, SolvedRay, samples};
use std::array::from_fn;
use std::iter::zip;
use support::Point;
use support::statistics::root_mean_square;
use surrogate::{FitError, SpotCheck, Surrogate, TestErrors};

/// Predictions of a surrogate with their targets, the values of the finite elements, state by
/// state.
#[derive(Debug, Default)]
pub struct Parity {
    /// Targets (`reference`) and predictions (`value`), in the order of the rays. Quantities that
    /// are unknown, or that the surrogate does not predict, are NaN.
    pub states: Vec<ComparedState>,
}

/// The rays with their samples inside the training domain of a surrogate.
pub fn inside(surrogate: &Surrogate, rays: &[SolvedRay]) -> Vec<SolvedRay> {
    let mut inside = rays.to_vec();
    for SolvedRay { design, samples, .. } in &mut inside {
        samples.retain(|sample| surrogate.contains(design, &sample.deformation()));
    }
    inside.retain(|ray| !ray.samples.is_empty());
    inside
}

/// The errors of a surrogate at random states on windows of a mesh tier, for its card.
pub fn spot_check(surrogate: &Surrogate, rays: &[SolvedRay], tier: &str) -> SpotCheck {
    let inside = inside(surrogate, rays);
    let widths = samples(&inside).map(|(ray, _)| ray.design.w_lig);
    SpotCheck {
        errors: Parity::new(surrogate, rays).errors(),
        inside: samples(&inside).count(),
        tier: Some(tier.to_owned()),
        forces: Parity::new(surrogate, &inside).force_errors(widths),
    }
}

impl Parity {
    /// Evaluates the surrogate at every sample.
    pub fn new(surrogate: &Surrogate, rays: &[SolvedRay]) -> Self {
        let (designs, deformations): (Vec<_>, Vec<_>) =
            samples(rays).map(|(ray, sample)| (ray.design, sample.deformation())).unzip();
        let predictions = surrogate.samples(&designs, &deformations);
        let states = zip(&predictions, samples(rays))
            .map(|(prediction, (_, sample))| ComparedState::new(prediction, sample));
        Self { states: states.collect() }
    }

    /// [target, prediction] of the quantity `i` of [`dataset::COMPARED`] in every state.
    pub fn points(&self, i: usize) -> impl Iterator<Item = Point> {
        self.states.iter().map(move |state| [state.reference[i], state.value[i]])
    }

    /// The errors by quantity.
    pub fn errors(&self) -> TestErrors {
        let by_quantity = from_fn(|i| fit_error(self.points(i)));
        TestErrors::new(self.states.len(), by_quantity)
    }

    /// Root mean square errors of (F_a, F_s, M_theta / w_lig), each over the Euclidean norm of the
    /// three by the finite elements in its state, for the ligament widths of the states; `None`
    /// without a state under load.
    pub fn force_errors(&self, widths: impl Iterator<Item = f64>) -> Option<[f64; 3]> {
        let errors: Vec<[f64; 3]> = zip(&self.states, widths)
            .filter_map(|(state, w_lig)| {
                let forces = |of: [f64; 6]| [of[1], of[2], of[3] / w_lig];
                let [value, reference] = [state.value, state.reference].map(forces);
                let norm = reference.iter().map(|force| force * force).sum::<f64>().sqrt();
                let error = |i: usize| (value[i] - reference[i]) / norm;
                (norm > 0.0).then(|| from_fn(error))
            })
            .collect();
        let rms = |i: usize| root_mean_square(errors.iter().map(|error| error[i]));
        (!errors.is_empty()).then(|| from_fn(rms))
    }

    /// The loss (15) in the scales of the training rays.
    pub(crate) fn loss(&self, scales: &Scales) -> f64 {
        let [f_a, f_s, m_theta] = scales.forces;
        let force_weight = (1.0 - ENERGY_WEIGHT) / 3.0;
        let damages = 1 + usize::from(scales.peak.is_some());
        let damage_weight = DAMAGE_WEIGHT / damages as f64;
        let terms = [
            (scales.energy, ENERGY_WEIGHT),
            (f_a, force_weight),
            (f_s, force_weight),
            (m_theta, force_weight),
            (scales.damage, damage_weight),
        ];
        let peak = scales.peak.map(|scale| (scale, damage_weight));
        let terms = terms.into_iter().chain(peak).enumerate();
        terms.map(|(i, (scale, weight))| weight * (rms_error(self.points(i)) / scale).powi(2)).sum()
    }

    /// The relative root mean square error of each network, by which its best epoch is chosen: the
    /// geometric mean of the known errors of W and the forces; the error of D; and the error of
    /// D_peak. NaN if it is unknown. The geometric mean prevents a few states of large force,
    /// which dominate the loss, from determining the choice. The error of each state is limited to
    /// the root mean square of its quantity, so a single ray far from all training rays does
    /// not determine the choice.
    pub(crate) fn network_errors(&self) -> [f64; 3] {
        let [w, f_a, f_s, m_theta, damage, damage_peak] =
            from_fn(|i| limited_error(self.points(i)));
        let potential = [w, f_a, f_s, m_theta].into_iter();
        let known: Vec<f64> = potential.filter(|error| !error.is_nan()).collect();
        let mean = match known.len() {
            0 => f64::NAN,
            count => known.iter().product::<f64>().powf(1.0 / count as f64),
        };
        [mean, damage, damage_peak]
    }
}

/// The root mean square error divided by the root mean square of the targets, each error being
/// limited to the latter; NaN if no target is known and predicted, or all are zero.
fn limited_error(points: impl Iterator<Item = Point>) -> f64 {
    let known: Vec<Point> = known(points).filter(|[_, predicted]| !predicted.is_nan()).collect();
    let target = root_mean_square(known.iter().map(|[target, _]| *target));
    let errors =
        known.iter().map(|[target_here, predicted]| (predicted - target_here).abs().min(target));
    if target > 0.0 { root_mean_square(errors) / target } else { f64::NAN }
}

fn rms_error(points: impl Iterator<Item = Point>) -> f64 {
    root_mean_square(known(points).map(|[target, predicted]| predicted - target))
}

/// The points whose target is known.
fn known(points: impl Iterator<Item = Point>) -> impl Iterator<Item = Point> {
    points.filter(|[target, _]| !target.is_nan())
}

/// Errors of points [target, prediction] relative to the targets; unknown if no target is known,
/// or all are zero.
pub(crate) fn fit_error(points: impl Iterator<Item = Point>) -> FitError {
    let points: Vec<Point> = known(points).collect();
    let target = root_mean_square(points.iter().map(|[target, _]| *target));
    let nonzero = points.iter().filter(|[target, _]| *target != 0.0);
    let mut relative: Vec<f64> =
        nonzero.map(|[target, predicted]| ((predicted - target) / target).abs()).collect();
    relative.sort_by(f64::total_cmp);
    match relative.get(relative.len() / 2) {
        Some(&median) => FitError { relative_rmse: rms_error(points.into_iter()) / target, median },
        None => FitError::unknown(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Forces (3, 4, 0) N with errors of 0.5 and -1 N, and a moment of 20 N mm at 2 mm with an
    /// error of 2 N mm.
    #[test]
    fn errors_of_forces_are_relative_to_the_norm_of_their_state() {
        let state = |reference: [f64; 3], error: [f64; 3]| {
            let all = |of: [f64; 3]| [1.0, of[0], of[1], of[2], 0.0, 0.0];
            ComparedState {
                reference: all(reference),
                value: all(std::array::from_fn(|i| reference[i] + error[i])),
            }
        };
        let states = vec![
            state([3.0, 4.0, 0.0], [0.5, -1.0, 0.0]),
            state([0.0, 0.0, 20.0], [0.0, 0.0, 2.0]),
        ];
        let found = Parity { states }.force_errors([2.0, 2.0].into_iter()).unwrap();
        let half = 0.5_f64.sqrt();
        for (found, expected) in std::iter::zip(found, [0.1, 0.2, 0.1]) {
            assert!((found - expected * half).abs() < 1e-12, "{found} {expected}");
        }
        assert_eq!(Parity::default().force_errors(std::iter::empty()), None);
    }

    #[test]
    fn errors_are_relative_to_the_targets() {
        let points = [[0.0, 0.3], [3.0, 3.3], [-4.0, -4.0], [5.0, 4.0]];
        let error = fit_error(points.into_iter());
        let expected = ((0.09 + 0.09 + 1.0) / 50.0_f64).sqrt();
        assert!((error.relative_rmse - expected).abs() < 1e-12);
        assert!((error.median - 0.1).abs() < 1e-12);
    }

    #[test]
    fn the_error_of_one_outlying_state_is_limited() {
        let limited = |points: &[[f64; 2]]| limited_error(points.iter().copied());
        let fit = |points: &[[f64; 2]]| fit_error(points.iter().copied());
        let errors = [[2.0, 2.1], [2.0, 1.9], [2.0, f64::INFINITY]];
        assert!((limited(&errors[..2]) - 0.05).abs() < 1e-12);
        assert!((limited(&errors) - (0.0025 * 2.0 / 3.0 + 1.0 / 3.0_f64).sqrt()).abs() < 1e-12);
        let (unknown, zero) = ([f64::NAN, 1.0], [0.0, 1.0]);
        for points in [vec![], vec![unknown], vec![zero, unknown]] {
            assert!(limited(&points).is_nan());
            assert!(fit(&points).relative_rmse.is_nan());
            assert!(fit(&points).median.is_nan());
        }
        assert_eq!(fit(&[[2.0, 2.1], unknown]).relative_rmse, fit(&[[2.0, 2.1]]).relative_rmse);
    }

    #[test]
    fn a_quantity_without_a_network_has_no_known_error() {
        let unpredicted = [[2.0, f64::NAN], [1.0, f64::NAN]];
        assert!(limited_error(unpredicted.into_iter()).is_nan());
        assert!(fit_error(unpredicted.into_iter()).relative_rmse.is_nan());
        assert!(fit_error(unpredicted.into_iter()).median.is_nan());
    }
}
