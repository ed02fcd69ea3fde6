//! Tolerances of the cut sheet, which the error budget of a design contains.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A tolerance is so many standard deviations.
const TOLERANCE: f64 = 2.0;

/// Tolerances of the cut sheet for the error budget of the report, as two standard deviations. A run continues under other
/// values, which change its report only.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ToleranceConfig {
    /// Tolerance +- of the width of every ligament by itself, from where the cutter ends its cuts (mm): an option of `kirigami
    /// inspect tolerances`, no key.
    #[serde(skip)]
    pub ligament: Option<f64>,
    /// Tolerance +- of the width that the cutter removes (mm): half of it moves the edge of a ligament and that of its hole.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub kerf: Option<f64>,
    /// Tolerance +- of the thickness of the sheet (mm).
    #[schemars(range(min = 0.0, max = 1.0))]
    pub thickness: Option<f64>,
}

/// The standard deviations of the errors of cutting (mm).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorDeviations {
    /// Of the width of every ligament by itself.
    pub ligament: f64,
    /// Of the kerf.
    pub kerf: f64,
    /// Of the thickness.
    pub thickness: f64,
}

impl ToleranceConfig {
    /// The standard deviations; 0 without tolerance.
    pub(crate) fn deviations(self) -> ErrorDeviations {
        let [ligament, kerf, thickness] = [self.ligament, self.kerf, self.thickness]
            .map(|tolerance| tolerance.unwrap_or(0.0) / TOLERANCE);
        ErrorDeviations {
            ligament,
            kerf,
            thickness,
        }
    }
}
