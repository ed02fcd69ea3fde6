//! The features (13) with the radius of the hole, and their standardisation.
//!
//! ```text
//! xi = [eta_a, eta_s, theta, log w_lig, alpha, rho_f],   eta = (a, s) / w_lig          (13)
//! ```
//!
//! In weights that were trained at one radius of the hole, rho_f is no feature: the networks have
//! five inputs.

use hinge::{DesignGradient, HingeDeformation, HingeDesign, HingeGradient};
use serde::{Deserialize, Serialize};

/// Number of features, including the feature of the hole.
pub(crate) const FEATURES: usize = 6;

/// Number of features of weights for one radius of the hole: the features of (13).
const OF_ONE_HOLE: usize = 5;

/// Position of log w_lig among the features.
pub(crate) const LOG_WIDTH: usize = 3;

/// The features in their order; the card of a surrogate contains them too.
pub const FEATURE_NAMES: [&str; FEATURES] =
    ["a / w_lig", "s / w_lig", "theta", "log w_lig", "alpha", "hole radius / w_lig"];

/// The features of weights that were trained on holes of one radius, or of several.
pub fn feature_names(several_holes: bool) -> &'static [&'static str] {
    &FEATURE_NAMES[..if several_holes { FEATURES } else { OF_ONE_HOLE }]
}

/// The features xi, with w_lig in mm and angles in rad.
pub fn features(design: &HingeDesign, deformation: &HingeDeformation) -> [f64; FEATURES] {
    let [eta_a, eta_s] = deformation.eta(design.w_lig);
    [eta_a, eta_s, deformation.theta, design.w_lig.ln(), design.alpha, design.fillet_ratio]
}

/// Mean and standard deviation of each feature over the training set; the input of the networks is
/// (xi - mean) / std.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Standardisation {
    /// Mean of each feature, in the order of [`FEATURE_NAMES`].
    pub mean: Vec<f64>,
    /// Standard deviation of each feature, in the order of [`FEATURE_NAMES`].
    pub std: Vec<f64>,
}

/// Transforms a gradient in the features (13) to a gradient in deformation and design.
pub(crate) fn pull_back(
    gradient: [f64; FEATURES],
    design: &HingeDesign,
    deformation: &HingeDeformation,
) -> HingeGradient {
    let w = design.w_lig;
    let [eta_a, eta_s] = deformation.eta(w);
    let [by_eta_a, by_eta_s, by_theta, by_log_w, by_alpha, by_hole] = gradient;
    [
        by_eta_a / w,
        by_eta_s / w,
        by_theta,
        (by_log_w - eta_a * by_eta_a - eta_s * by_eta_s) / w,
        by_alpha,
        by_hole,
    ]
    .into()
}

// The energy of one hinge with the derivatives that are asked for.

/// Number of features of the deformation; the others, log w_lig, alpha and rho_f, depend on the
/// design only.
pub(crate) const DEFORMATION_FEATURES: usize = 3;
/// The derivatives to compute; each order includes all earlier ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Order {
    /// W
    Value,
    /// additionally the gradient in (a, s, theta)
    Forces,
    /// additionally the Hessian in (a, s, theta)
    Tangent,
    /// additionally the gradient in (w_lig, alpha, rho_f) and the mixed second derivatives
    Design,
}

impl Order {
    /// Number of features with second derivatives.
    pub(crate) fn tangents(self) -> usize {
        match self {
            Self::Value | Self::Forces => 0,
            Self::Tangent => DEFORMATION_FEATURES,
            Self::Design => FEATURES,
        }
    }
}

/// Energy of one hinge and its derivatives; derivatives beyond the requested order are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HingeEnergy {
    /// W (N mm).
    pub w: f64,
    /// dW/d(a, s, theta): (F_a, F_s, M_theta) in (N, N, N mm).
    pub forces: [f64; 3],
    /// d2W/d(a, s, theta)^2.
    pub tangent: [[f64; 3]; 3],
    /// dW/dg at fixed (a, s, theta).
    pub design: DesignGradient,
    /// d2W/d(a, s, theta)dg.
    pub mixed: [DesignGradient; 3],
}
