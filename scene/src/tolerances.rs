//! Tolerances of the cut sheet, which the error budget of a design contains.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Tolerances of the cut sheet for the error budget of the report, as two standard deviations. A
/// run continues under other values, which change its report only.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ToleranceConfig {
    /// Tolerance +- of the width that the cutter removes (mm): half of it moves the edge of a
    /// ligament and the edge of its hole.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub kerf: Option<f64>,
    /// Tolerance +- of the thickness of the sheet (mm).
    #[schemars(range(min = 0.0, max = 1.0))]
    pub thickness: Option<f64>,
}
