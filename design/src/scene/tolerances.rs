//! Tolerances of the cut sheet: the error budget of a design contains them, and `objective.robust` designs for them.

use crate::objective::cut_sheets::ErrorDeviations;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A tolerance is so many standard deviations.
const TOLERANCE: f64 = 2.0;

/// Tolerances of the cut sheet for the error budget of the report and for `objective.robust`, as two standard deviations. Without
/// `objective.robust` a run continues under other values, which change its report only.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ToleranceConfig {
    /// Tolerance +- of the width of every ligament by itself, from where the cutter ends its cuts (mm). `kirigami inspect
    /// tolerances` reads it, the error budget does not.
    #[schemars(range(min = 0.0, max = 5.0))]
    pub ligament: Option<f64>,
    /// Tolerance +- of the width that the cutter removes (mm): half of it moves the edge of a ligament and that of its hole.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub kerf: Option<f64>,
    /// Tolerance +- of the thickness of the sheet (mm).
    #[schemars(range(min = 0.0, max = 1.0))]
    pub thickness: Option<f64>,
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
