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
    /// Tolerance +- of the width that the cutter removes (mm): half of it moves the edge of a ligament and that of its hole.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub kerf: Option<f64>,
    /// Tolerance +- of the thickness of the sheet (mm).
    #[schemars(range(min = 0.0, max = 1.0))]
    pub thickness: Option<f64>,
}

impl ToleranceConfig {
    /// The standard deviations of kerf and thickness (mm); 0 without tolerance.
    pub(crate) fn deviations(self) -> [f64; 2] {
        [self.kerf, self.thickness].map(|tolerance| tolerance.unwrap_or(0.0) / TOLERANCE)
    }
}
