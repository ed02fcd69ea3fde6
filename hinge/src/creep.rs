//! How far a material gives way under a load that stays.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Creep of the material, by order of magnitude, which the report of a design states; no solve uses it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Creep {
    /// Deformation after `years` under a constant small load, over that at once (ISO 9967: the creep ratio); the stiffness falls to its
    /// reciprocal.
    #[schemars(range(min = 1.0, max = 100.0))]
    pub ratio: f64,
    /// Time under load, in years.
    #[schemars(range(min = 1e-3, max = 100.0))]
    pub years: f64,
    /// Where the ratio is from.
    pub source: String,
}
