//! The features (13) and their standardisation.
//!
//! ```text
//! xi = [eta_a, eta_s, theta, log w_lig, alpha],   eta = (a, s) / w_lig          (13)
//! ```

use hinge::{HingeDeformation, HingeDesign};
use serde::{Deserialize, Serialize};

/// Number of features of (13).
pub(crate) const FEATURES: usize = 5;

/// Position of log w_lig among the features.
pub(crate) const LOG_WIDTH: usize = 3;

/// The features of (13) in their order; the card of a surrogate contains them too.
pub const FEATURE_NAMES: [&str; FEATURES] =
    ["a / w_lig", "s / w_lig", "theta", "log w_lig", "alpha"];

/// The features xi of (13), with w_lig in mm and angles in rad.
pub fn features(design: &HingeDesign, deformation: &HingeDeformation) -> [f64; FEATURES] {
    let [eta_a, eta_s] = deformation.eta(design.w_lig);
    [
        eta_a,
        eta_s,
        deformation.theta,
        design.w_lig.ln(),
        design.alpha,
    ]
}

/// Mean and standard deviation of each feature over the training set; the input of the networks is
/// (xi - mean) / std.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Standardisation {
    /// Mean of each feature, in the order of [`FEATURE_NAMES`].
    pub mean: [f64; FEATURES],
    /// Standard deviation of each feature, in the order of [`FEATURE_NAMES`].
    pub std: [f64; FEATURES],
}

/// Transforms a gradient in the features (13) to a gradient in (a, s, theta, w_lig, alpha).
pub(crate) fn pull_back(
    gradient: [f64; FEATURES],
    design: &HingeDesign,
    deformation: &HingeDeformation,
) -> [f64; FEATURES] {
    let w = design.w_lig;
    let [eta_a, eta_s] = deformation.eta(w);
    let [by_eta_a, by_eta_s, by_theta, by_log_w, by_alpha] = gradient;
    [
        by_eta_a / w,
        by_eta_s / w,
        by_theta,
        (by_log_w - eta_a * by_eta_a - eta_s * by_eta_s) / w,
        by_alpha,
    ]
}
