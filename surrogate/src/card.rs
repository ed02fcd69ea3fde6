//! The card of a weight file: units, scaling, training domain, provenance, test errors.

use crate::features::{LOG_WIDTH, Standardisation, feature_names};
use crate::network::{finite, other_shape};
use hinge::{HingeConstants, TrainingDomain};
use serde::{Deserialize, Deserializer, Serialize};
use support::{Fault, ensure};

/// Format version of the weight file and its card; no other version is read.
pub const FORMAT_VERSION: u32 = 10;

/// The units of all inputs and outputs of a surrogate.
pub const UNITS: &str = "mm, N, MPa, N mm, rad";

/// The contents of the card `X.json` of a weight file `X.safetensors`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Card {
    /// [`FORMAT_VERSION`] of the writer.
    pub format_version: u32,
    /// BLAKE3 of the weight file `X.safetensors`; `None` in memory.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub weights_hash: Option<String>,
    /// [`UNITS`]
    pub units: String,
    /// [`feature_names`]
    pub features: Vec<String>,
    /// Mean and standard deviation of the features over the training rows.
    pub standardisation: Standardisation,
    /// W_s of (14) (N mm).
    pub energy_scale: f64,
    /// D_s of (14).
    pub damage_scale: f64,
    /// The scale of D_peak, if there is a head for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peak_scale: Option<f64>,
    /// beta of the damage heads. A larger value gives a sharper transition from no damage to damage
    /// at yield.
    pub damage_sharpness: f64,
    /// The states that the training rows cover.
    pub domain: TrainingDomain,
    /// The components of the hinge design that are not features; the weights are valid only for
    /// these values. If the domain has holes of several radii, `fillet_ratio` is the ratio of the
    /// hinge whose features the networks see ([`hinge::NetLigament`]).
    pub hinge: HingeConstants,
    /// Name of the sheet material.
    pub material: String,
    /// [`hinge::SheetMaterial::law_hash`] of the material, if known; a material may change without
    /// a change of name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material_hash: Option<String>,
    /// Hash of the settings of the campaign in which the rows were solved, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settings_hash: Option<String>,
    /// Tier of the window mesh on which the rows were solved.
    pub tier: String,
    /// Whether the rays of the database bend like the free turn of a ligament; see
    /// [`Surrogate::ray_curvature`].
    ///
    /// [`Surrogate::ray_curvature`]: crate::Surrogate::ray_curvature
    #[serde(default)]
    pub bent_rays: bool,
    /// Hash of the database file.
    pub dataset_hash: String,
    /// [`Surrogate::hash`] of the initial weights of fine-tuned ones.
    ///
    /// [`Surrogate::hash`]: crate::Surrogate::hash
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fine_tuned_from: Option<String>,
    /// The ensemble whose median the weights are also trained on, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub distillation: Option<DistillationRecord>,
    /// Hash of the split into training, validation and test.
    pub split_hash: String,
    /// The training configuration.
    pub training: serde_json::Value,
    /// Number of training rays, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub training_rays: Option<usize>,
    /// Training time (s), if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub training_s: Option<f64>,
    /// Errors on the test split.
    pub test_errors: TestErrors,
    /// Errors at random states of the campaign's region, which no training has seen, if they were
    /// measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spot_check: Option<SpotCheck>,
    /// Errors on the paths of the hinges of designed sheets, if they were measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub visited: Option<SpotCheck>,
}

impl Card {
    /// The errors where designed sheets go, or else at random states, and which of them they are.
    pub fn check(&self) -> Option<(&SpotCheck, &'static str)> {
        let visited = self.visited.as_ref().map(|check| (check, "visited"));
        visited.or(self.spot_check.as_ref().map(|check| (check, "random")))
    }
}

/// Errors of a surrogate at states that no training has seen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpotCheck {
    /// Errors at all states.
    pub errors: TestErrors,
    /// Number of the states that lie inside the training domain.
    pub inside: usize,
    /// Tier of the window mesh of the states, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tier: Option<String>,
    /// Root mean square errors of (F_a, F_s, M_theta / w_lig) at the states inside, each over the
    /// Euclidean norm of the three at its state, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub forces: Option<[f64; 3]>,
}

/// The ensemble whose median predictions weights were also trained on, at states that no solver has
/// computed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DistillationRecord {
    /// The networks of the ensemble.
    pub teachers: Vec<Teacher>,
    /// BLAKE3 hash (hexadecimal) of the states and of the median predictions there.
    pub hash: String,
}

/// One network of an ensemble; the hashes are the values of [`Surrogate::hash`].
///
/// [`Surrogate::hash`]: crate::Surrogate::hash
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Teacher {
    /// Hash of the network.
    pub weights: String,
    /// Hash of the weights that the network was fine-tuned from, if it was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fine_tuned_from: Option<String>,
}

/// Errors of a surrogate on rows that were not used in training.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TestErrors {
    /// Number of rows.
    pub rows: usize,
    /// Error of W.
    pub energy: FitError,
    /// Error of F_a.
    pub f_a: FitError,
    /// Error of F_s.
    pub f_s: FitError,
    /// Error of M_theta.
    pub m_theta: FitError,
    /// Error of D.
    pub damage: FitError,
    /// Error of D_peak; unknown if no head predicts it.
    pub damage_peak: FitError,
}

/// Deviation of predictions from their targets; NaN if unknown, which is `null` in a card.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitError {
    /// Root mean square of the error, divided by the root mean square of the target.
    #[serde(deserialize_with = "number_or_null")]
    pub relative_rmse: f64,
    /// Median of |error| / |target| over the rows with a non-zero target.
    #[serde(deserialize_with = "number_or_null")]
    pub median: f64,
}

impl FitError {
    /// The error without a known target that is not zero.
    pub fn unknown() -> Self {
        Self { relative_rmse: f64::NAN, median: f64::NAN }
    }
}

fn number_or_null<'de, D: Deserializer<'de>>(value: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(value)?.unwrap_or(f64::NAN))
}

impl TestErrors {
    /// The errors of W, F_a, F_s, M_theta, D, D_peak on a number of rows.
    pub fn new(rows: usize, by_quantity: [FitError; 6]) -> Self {
        let [energy, f_a, f_s, m_theta, damage, damage_peak] = by_quantity;
        Self { rows, energy, f_a, f_s, m_theta, damage, damage_peak }
    }

    /// Relative root mean square errors (%): W, F_a, F_s, M_theta, D, D_peak.
    pub fn percents(&self) -> [f64; 6] {
        self.by_quantity().map(|error| 100.0 * error.relative_rmse)
    }

    /// The errors of W, F_a, F_s, M_theta, D, D_peak.
    pub fn by_quantity(&self) -> [FitError; 6] {
        [self.energy, self.f_a, self.f_s, self.m_theta, self.damage, self.damage_peak]
    }

    /// Root mean square of the errors of the three forces (%).
    pub fn forces_percent(&self) -> f64 {
        let [_, f_a, f_s, m_theta, ..] = self.percents();
        ((f_a * f_a + f_s * f_s + m_theta * m_theta) / 3.0).sqrt()
    }
}

impl Card {
    /// The card of the same networks with all lengths multiplied by `factor`; see
    /// [`Surrogate::scaled`].
    ///
    /// [`Surrogate::scaled`]: crate::Surrogate::scaled
    pub(crate) fn scaled(mut self, factor: f64) -> Self {
        self.standardisation.mean[LOG_WIDTH] += factor.ln();
        self.energy_scale *= factor.powi(3);
        self.domain.w_lig = self.domain.w_lig.map(|w_lig| factor * w_lig);
        self.hinge.kerf *= factor;
        self.hinge.r_win *= factor;
        self
    }

    /// The scale of D, followed by the scale of D_peak if there is a head for it.
    pub(crate) fn damage_scales(&self) -> Vec<f64> {
        std::iter::once(self.damage_scale).chain(self.peak_scale).collect()
    }

    /// Rejects other units or features, scales that are not positive, and means that are not
    /// finite.
    pub(crate) fn validate(&self) -> Result<(), Fault> {
        let names = feature_names(self.domain.holes.is_some());
        for (key, found, expected) in [
            ("units", self.units.clone(), UNITS.into()),
            ("features", self.features.join(", "), names.join(", ")),
        ] {
            ensure!(found == expected, "the {key} of the card are {found}, expected {expected}");
        }
        let damages = self.damage_scales().into_iter();
        let scales = [
            ("w_scale".into(), self.energy_scale),
            ("damage_sharpness".into(), self.damage_sharpness),
        ]
        .into_iter()
        .chain(damages.map(|scale| ("d_scale".into(), scale)));
        let Standardisation { mean, std } = &self.standardisation;
        for (tensor, values) in [("feat_mean", mean), ("feat_std", std)] {
            if values.len() != names.len() {
                let expected = format!("[{}]", names.len());
                return Err(other_shape(tensor, &expected, &[values.len()]));
            }
        }
        let deviations = names.iter().zip(std.iter().copied());
        let deviations = deviations.map(|(name, std)| (format!("feat_std of {name}"), std));
        for (name, value) in scales.chain(deviations) {
            ensure!(
                value > 0.0 && value.is_finite(),
                "`{name}` = {value} violates 0 < {name} < infinity"
            );
        }
        finite("feat_mean", mean)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_that_is_not_known_is_null_on_the_card() {
        let errors =
            TestErrors { rows: 3, damage_peak: FitError::unknown(), ..TestErrors::default() };
        let text = serde_json::to_string(&errors).unwrap();
        assert!(text.contains(r#""damage_peak":{"relative_rmse":null,"median":null}"#));
        let read: TestErrors = serde_json::from_str(&text).unwrap();
        assert!(read.damage_peak.relative_rmse.is_nan() && read.damage_peak.median.is_nan());
        assert_eq!(read.energy, errors.energy);
    }
}
