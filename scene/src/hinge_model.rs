//! The sections of a scene that its hinge laws read.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// The ideal deployment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PinConfig {
    /// The opening angle at the start of the search (deg); it is a design variable, unless it is
    /// `held`.
    #[schemars(range(min = -180.0, max = 180.0))]
    pub opening_deg: f64,
    /// Whether the opening is held at `opening_deg` during the search.
    #[serde(default)]
    pub held: bool,
}

/// The spring constants of (11).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LinearConstants {
    /// Stiffness of the axial opening a (N/mm).
    #[schemars(range(min = 1e-3, max = 1e6))]
    pub k_a: f64,
    /// Stiffness of the shear s (N/mm).
    #[schemars(range(min = 1e-3, max = 1e6))]
    pub k_s: f64,
    /// Stiffness of the rotation theta (N mm/rad).
    #[schemars(range(min = 1e-3, max = 1e9))]
    pub k_theta: f64,
}

/// The weights of (14).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SurrogateFile {
    /// Path of the weights `X.safetensors`, relative to the scene file; their card `X.json` is read
    /// from the same folder.
    pub weights: PathBuf,
    /// A smaller network of the same hinges, which the level `draft` reads.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub draft: Option<PathBuf>,
    /// Further networks trained on the same data (`train --seeds`); the report states their spread,
    /// and the level `fine` takes their mean.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ensemble: Vec<PathBuf>,
    /// The law of released hinges, from which the report states the residual opening when the loads
    /// are taken off. A run continues under another one, which changes its report only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub springback: Option<PathBuf>,
    /// The hinges of this sheet by finite elements, written by `kirigami design --level final`, to
    /// which the level `final` corrects the learned energy.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solved_hinges: Option<PathBuf>,
}
