//! The energy of one hinge with the derivatives that are asked for.

use hinge::DesignGradient;

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
    /// Number of features with second derivatives, of a network with `features` inputs.
    pub(crate) fn tangents(self, features: usize) -> usize {
        match self {
            Self::Value | Self::Forces => 0,
            Self::Tangent => DEFORMATION_FEATURES,
            Self::Design => features,
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
