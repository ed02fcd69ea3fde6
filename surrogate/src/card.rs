//! The card beside the weights: units, scaling, training domain, provenance, test errors.

use crate::features::{FEATURE_NAMES, Standardisation};
use crate::network::InvalidWeights;
use hinge::{HingeConstants, TrainingDomain};
use serde::{Deserialize, Serialize};

/// Version of the weight file and its card that this crate writes; it reads those before too.
///
/// 1: the damage head predicts D. 2: it may predict D_peak too; errors by bins. 3: the hashes of
/// the material law and of the campaign's settings. 4: D_peak has a head of its own; beta;
/// what the training took. 5: the domain is what the rows fill, not their box; D_peak is the mean over the
/// most strained 1 % of the ligament, and that of older weights, of another measure, is left out.
pub const FORMAT_VERSION: u32 = 5;

/// The units of everything a surrogate takes and returns.
pub const UNITS: &str = "mm, N, MPa, N mm, rad";

/// What stands in `X.json` beside `X.safetensors`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Card {
    /// [`FORMAT_VERSION`] of the writer.
    pub format_version: u32,
    /// [`UNITS`]
    pub units: String,
    /// [`FEATURE_NAMES`]
    pub features: Vec<String>,
    /// Mean and standard deviation of the features over the training rows.
    pub standardisation: Standardisation,
    /// W_s of (14) (N mm).
    pub energy_scale: f64,
    /// D_s of (14).
    pub damage_scale: f64,
    /// The same of D_peak, if there is a head for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peak_scale: Option<f64>,
    /// beta of the damage heads: how sharply they tell a ligament that yields from one that does
    /// not.
    #[serde(default = "one")]
    pub damage_sharpness: f64,
    /// The states of the training rows.
    pub domain: TrainingDomain,
    /// The parts of the hinge design that are no feature of (13); the weights hold for these alone.
    pub hinge: HingeConstants,
    /// Name of the sheet material.
    pub material: String,
    /// [`hinge::SheetMaterial::law_hash`] of it, if known: a material may change and keep its name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material_hash: Option<String>,
    /// Hash of the settings of the campaign that the rows were solved in, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settings_hash: Option<String>,
    /// Tier of the window mesh that the rows were solved with.
    pub tier: String,
    /// Hash of the database file.
    pub dataset_hash: String,
    /// Hash of the database of the weights that the training began from, if any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fine_tuned_from: Option<String>,
    /// Hash of the split into training, validation and test.
    pub split_hash: String,
    /// The training configuration, as it was read.
    pub training: serde_json::Value,
    /// Rays that it was trained on, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub training_rays: Option<usize>,
    /// Time that the training took (s), if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub training_s: Option<f64>,
    /// Errors on the test split.
    pub test_errors: TestErrors,
    /// The same by bins of single quantities.
    #[serde(default)]
    pub error_bins: Vec<ErrorBin>,
}

/// Errors of a surrogate on rows that training never saw.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TestErrors {
    /// Number of rows.
    pub rows: usize,
    pub energy: FitError,
    pub f_a: FitError,
    pub f_s: FitError,
    pub m_theta: FitError,
    pub damage: FitError,
    /// Zero where no head predicts it.
    #[serde(default)]
    pub damage_peak: FitError,
}

/// Errors on the test rows in which one quantity lies in an interval.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ErrorBin {
    /// `eta_a`, `eta_s`, `theta_deg`, `w_lig`, `alpha_deg`, or `edge`: [`TrainingDomain::depth`], 0 at the edge of
    /// the training domain and 1 at its centre.
    pub quantity: String,
    /// Lower and upper end; the upper belongs to the next bin.
    pub range: [f64; 2],
    pub errors: TestErrors,
}

/// How far predictions lie from their targets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitError {
    /// Root mean square of the error over the root mean square of the target.
    pub relative_rmse: f64,
    /// Median over the rows with a target other than zero of |error| / |target|.
    pub median: f64,
}

impl TestErrors {
    /// Relative root mean square errors (%): W, F_a, F_s, M_theta, D, D_peak.
    pub fn percents(&self) -> [f64; 6] {
        let Self {
            energy,
            f_a,
            f_s,
            m_theta,
            damage,
            damage_peak,
            ..
        } = *self;
        [energy, f_a, f_s, m_theta, damage, damage_peak].map(|error| 100.0 * error.relative_rmse)
    }
}

impl Card {
    /// Of D, and of D_peak if there is a head for it.
    pub(crate) fn damage_scales(&self) -> Vec<f64> {
        std::iter::once(self.damage_scale)
            .chain(self.peak_scale)
            .collect()
    }

    /// Refuses other units or features, scales that are not positive, domains without a state.
    pub(crate) fn validate(&self) -> Result<(), InvalidWeights> {
        for (key, found, expected) in [
            ("units", self.units.clone(), UNITS.into()),
            (
                "features",
                self.features.join(", "),
                FEATURE_NAMES.join(", "),
            ),
        ] {
            if found != expected {
                return Err(InvalidWeights::OtherConvention {
                    key,
                    expected,
                    found,
                });
            }
        }
        let damages = self.damage_scales().into_iter();
        let scales = [
            ("w_scale".into(), self.energy_scale),
            ("damage_sharpness".into(), self.damage_sharpness),
        ]
        .into_iter()
        .chain(damages.map(|scale| ("d_scale".into(), scale)));
        let deviations = FEATURE_NAMES.iter().zip(self.standardisation.std);
        let deviations = deviations.map(|(name, std)| (format!("feat_std of {name}"), std));
        for (name, value) in scales.chain(deviations) {
            if !(value > 0.0 && value.is_finite()) {
                return Err(InvalidWeights::NotPositive { name, value });
            }
        }
        let mean = self.standardisation.mean;
        if let Some(index) = mean.iter().position(|value| !value.is_finite()) {
            return Err(InvalidWeights::NotFinite {
                tensor: "feat_mean".into(),
                index,
                value: mean[index],
            });
        }
        Ok(())
    }
}

/// The sharpness of the weights of before version 4.
fn one() -> f64 {
    1.0
}
