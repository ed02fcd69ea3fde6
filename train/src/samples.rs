//! Solved states as inputs and targets of the networks: standardised features, scaled targets, batches.

use crate::affine;
use burn::tensor::{Tensor, TensorCreationOptions, TensorData};
use dataset::SolvedRay;
use hinge::{HingeDeformation, HingeDesign, HingeSample, NetLigament};
use std::array::from_fn;
use support::{Fault, ensure, fault, statistics};
use surrogate::{Card, FEATURE_NAMES, Standardisation, feature_names, features};

/// The scales of (14) and (15), computed from the training rays.
#[derive(Debug)]
pub(crate) struct Scales {
    /// Standardisation of the hinges that the networks see; [`NetLigament`].
    pub standardisation: Standardisation,
    /// The hole of these hinges, over w_lig.
    pub hole: f64,
    /// W_s: root mean square of W (N mm).
    pub energy: f64,
    /// sigma_F,c: root mean square of (F_a, F_s, M_theta) in (N, N, N mm).
    pub forces: [f64; 3],
    /// D_s: root mean square of D.
    pub damage: f64,
    /// Root mean square of D_peak over the states that have it; `None` if none has a non-zero
    /// D_peak.
    pub peak: Option<f64>,
    /// Number of states divided by the number of those with D_peak. With this weight, a mean over
    /// all states is the mean over the states with D_peak.
    pub peak_weight: f64,
}

/// Maximum number of features.
const FEATURES: usize = FEATURE_NAMES.len();

/// One state: inputs of the networks and targets of (15), both of order one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// Standardised xi(eps, g). The networks see as many of them as the standardisation has.
    pub inputs: [f64; FEATURES],
    /// Standardised xi(0, g).
    pub origin: [f64; FEATURES],
    /// Factors from d|r|^2 / d(standardised eta_a, eta_s, theta) to (F_a, F_s, M_theta) / sigma_F.
    pub force_factors: [f64; 3],
    /// W / W_s
    pub energy: f64,
    /// (F_a, F_s, M_theta) / sigma_F
    pub forces: [f64; 3],
    /// D / D_s, and D_peak divided by its scale if it has one.
    pub damage: [f64; 2],
    /// Weights of the errors of D and D_peak; the weight of an unknown D_peak is zero.
    pub damage_weights: [f64; 2],
}

/// Samples as tensors, one row per sample.
pub(crate) struct Batch {
    /// Inputs of the undeformed and the deformed states, (2, n, features).
    pub states: Tensor<3>,
    pub force_factors: Tensor<2>,
    /// (n, 1)
    pub energy: Tensor<2>,
    pub forces: Tensor<2>,
    /// (n, 2)
    pub damage: Tensor<2>,
    /// (n, 2)
    pub damage_weights: Tensor<2>,
}

impl Scales {
    /// Computes the scales; an error if a feature is constant, or a target is zero or has outliers.
    ///
    /// `hole` is the hole of the hinges that the networks see, over w_lig, and `names` are their
    /// features. The rays include their mirror images.
    pub(crate) fn new(
        rays: &[SolvedRay],
        hole: f64,
        names: &[&'static str],
    ) -> Result<Self, Fault> {
        let states = || dataset::samples(rays);
        let samples = || states().map(|(_, sample)| sample);
        let count = samples().count() as f64;
        let root_mean_square = |target: &'static str, value: fn(&HingeSample) -> f64| {
            let scale = statistics::root_mean_square(samples().map(value));
            refuse_outlier(rays, target, value)?;
            if scale > 0.0 && scale.is_finite() {
                Ok(scale)
            } else {
                Err(fault!(
                    "the root mean square of {target} over the training states is {scale}, so it cannot be fitted; check the \
                     database"
                ))
            }
        };
        let xi: Vec<[f64; FEATURES]> = states()
            .map(|(ray, sample)| {
                let ligament = NetLigament::new(&ray.design, hole);
                let state = ligament.deformation(&sample.deformation());
                features(&ligament.design(&ray.design), &state)
            })
            .collect();
        let mean: Vec<f64> =
            (0..names.len()).map(|k| xi.iter().map(|xi| xi[k]).sum::<f64>() / count).collect();
        let std: Vec<f64> = (0..names.len())
            .map(|k| {
                let squares: f64 = xi.iter().map(|xi| (xi[k] - mean[k]).powi(2)).sum();
                (squares / count).sqrt()
            })
            .collect();
        for (k, &feature) in names.iter().enumerate() {
            // The rounding error of the mean gives a constant feature a standard deviation of this
            // size.
            ensure!(
                std[k] > 1e-12 * mean[k].abs() && std[k].is_finite(),
                "the feature `{feature}` is {} in every training state, so the network cannot \
                     learn its effect; vary it in the campaign",
                mean[k]
            );
        }
        let with_peak = samples().filter(|sample| sample.d_peak.is_some()).count();
        let peak_weight = count / (with_peak as f64).max(1.0);
        let mut standardisation = Standardisation { mean, std };
        affine::centre(&mut standardisation);
        Ok(Self {
            standardisation,
            hole,
            energy: root_mean_square("W", |sample| sample.w)?,
            forces: [
                root_mean_square("F_a", |sample| sample.f_a)?,
                root_mean_square("F_s", |sample| sample.f_s)?,
                root_mean_square("M_theta", |sample| sample.m_theta)?,
            ],
            damage: root_mean_square("D", |sample| sample.d)?,
            // The mean over all states counts those without D_peak as zero.
            peak: if samples().any(|sample| d_peak(sample) != 0.0) {
                Some(root_mean_square("D_peak", d_peak)? * peak_weight.sqrt())
            } else {
                None
            },
            peak_weight,
        })
    }

    /// The scales of trained weights; the scales of the forces are computed from the rays.
    pub(crate) fn from_card(card: &Card, rays: &[SolvedRay]) -> Result<Self, Fault> {
        Ok(Self {
            standardisation: card.standardisation.clone(),
            energy: card.energy_scale,
            damage: card.damage_scale,
            peak: card.peak_scale,
            ..Self::new(rays, card.hinge.fillet_ratio, feature_names(card.domain.holes.is_some()))?
        })
    }

    /// Number of features that the networks see.
    pub(crate) fn features(&self) -> usize {
        self.standardisation.mean.len()
    }

    /// One state in these scales.
    pub(crate) fn sample(&self, design: &HingeDesign, sample: &HingeSample) -> Sample {
        let Standardisation { mean, std } = &self.standardisation;
        let standardise = |xi: [f64; FEATURES]| -> [f64; FEATURES] {
            from_fn(|k| mean.get(k).map_or(0.0, |mean| (xi[k] - mean) / std[k]))
        };
        let ligament = NetLigament::new(design, self.hole);
        let (design, sample) = (&ligament.design(design), &ligament.sample(sample));
        // d(eta_a, eta_s, theta) / d(a, s, theta)
        let w = design.w_lig;
        let by_deformation = [1.0 / w, 1.0 / w, 1.0];
        let forces = sample.forces();
        Sample {
            inputs: standardise(features(design, &sample.deformation())),
            origin: standardise(features(design, &HingeDeformation::default())),
            force_factors: from_fn(|k| self.energy * by_deformation[k] / (std[k] * self.forces[k])),
            energy: sample.w / self.energy,
            forces: from_fn(|k| forces[k] / self.forces[k]),
            damage: [
                sample.d / self.damage,
                self.peak.map_or(0.0, |scale| sample.d_peak.unwrap_or(0.0) / scale),
            ],
            damage_weights: [1.0, sample.d_peak.map_or(0.0, |_| self.peak_weight)],
        }
    }
}

/// Maximum of a target over its 90 % quantile. Deployed hinges and the extremes of the box differ
/// by a factor of ten; an erroneous solve has larger errors, by powers of ten.
const OUTLIER: f64 = 100.0;

fn refuse_outlier(
    rays: &[SolvedRay],
    target: &'static str,
    value: fn(&HingeSample) -> f64,
) -> Result<(), Fault> {
    let states = || dataset::samples(rays);
    let mut sorted: Vec<f64> = states().map(|(_, sample)| value(sample).abs()).collect();
    sorted.sort_by(f64::total_cmp);
    let usual = sorted.get(9 * sorted.len() / 10).copied().unwrap_or(0.0);
    let outlier = states().find(|(_, sample)| value(sample).abs() > OUTLIER * usual);
    match outlier.filter(|_| usual > 0.0) {
        Some((ray, sample)) => Err(fault!(
            "job {}, lambda = {}: {target} = {:e} is {:.0} times the 90 % quantile of the training \
             states and would dominate the loss; check that job or remove it",
            ray.job,
            sample.lambda,
            value(sample),
            value(sample).abs() / usual
        )),
        None => Ok(()),
    }
}

/// D_peak; zero if it is unknown.
fn d_peak(sample: &HingeSample) -> f64 {
    sample.d_peak.unwrap_or(0.0)
}

impl Batch {
    /// The samples with the first `features` of their inputs.
    pub(crate) fn new(
        samples: &[Sample],
        features: usize,
        options: &TensorCreationOptions,
    ) -> Self {
        let seen = |of: fn(&Sample) -> [f64; FEATURES]| columns(samples, options, of);
        let undeformed = seen(|sample| sample.origin).narrow(1, 0, features);
        let deformed = seen(|sample| sample.inputs).narrow(1, 0, features);
        Self {
            states: Tensor::stack(vec![undeformed, deformed], 0),
            force_factors: columns(samples, options, |sample| sample.force_factors),
            energy: columns(samples, options, |sample| [sample.energy]),
            forces: columns(samples, options, |sample| sample.forces),
            damage: columns(samples, options, |sample| sample.damage),
            damage_weights: columns(samples, options, |sample| sample.damage_weights),
        }
    }

    /// Inputs of the deformed states, (n, features).
    pub(crate) fn deformed(&self) -> Tensor<2> {
        self.states.clone().narrow(0, 1, 1).squeeze_dim(0)
    }
}

fn columns<const N: usize>(
    samples: &[Sample],
    options: &TensorCreationOptions,
    values: impl Fn(&Sample) -> [f64; N],
) -> Tensor<2> {
    let flat: Vec<f64> = samples.iter().flat_map(values).collect();
    Tensor::from_data(TensorData::new(flat, [samples.len(), N]), options.clone())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Arbitrary samples of order one.
    pub fn samples(count: usize) -> Vec<Sample> {
        let value = |row: usize, column: usize| (1.7 * row as f64 + 2.3 * column as f64).sin();
        let sample = |row| Sample {
            inputs: std::array::from_fn(|k| value(row, k)),
            origin: std::array::from_fn(|k| if k < 3 { -0.3 } else { value(row, k) }),
            force_factors: std::array::from_fn(|k| 1.0 + 0.5 * value(row, 14 + k)),
            energy: value(row, 8).powi(2),
            forces: std::array::from_fn(|k| value(row, 9 + k)),
            damage: [12, 13].map(|column| value(row, column).abs()),
            damage_weights: [1.0, f64::from(u8::from(row % 3 > 0)) * 1.5],
        };
        (0..count).map(sample).collect()
    }
}
