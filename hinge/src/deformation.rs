//! The hinge deformation (8) and its work-conjugate forces.

use serde::{Deserialize, Serialize};

/// Relative motion of the two panels of a hinge, measured at O in their mean frame; (8).
///
/// With panel A fixed, panel B rotates by `theta` about O, and O on B moves by R(theta/2) (a, s).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HingeDeformation {
    /// Axial opening along the secondary cut (mm); positive in tension.
    pub a: f64,
    /// Shear across the secondary cut (mm).
    pub s: f64,
    /// Rotation of panel B relative to panel A (rad); positive opens the main cut.
    pub theta: f64,
}

impl HingeDeformation {
    /// The deformation from the dimensionless measures of (13) and the ligament width (mm).
    pub fn from_eta(eta_a: f64, eta_s: f64, theta: f64, w_lig: f64) -> Self {
        Self { a: eta_a * w_lig, s: eta_s * w_lig, theta }
    }

    /// (eta_a, eta_s) = (a, s) / w_lig; (13).
    pub fn eta(&self, w_lig: f64) -> [f64; 2] {
        [self.a / w_lig, self.s / w_lig]
    }

    /// The point at the fraction `lambda` of the straight ray from the undeformed state.
    pub fn at(&self, lambda: f64) -> Self {
        Self { a: lambda * self.a, s: lambda * self.s, theta: lambda * self.theta }
    }

    /// The similar deformation in a sheet of `factor` times the thickness.
    pub fn scaled(&self, factor: f64) -> Self {
        Self { a: factor * self.a, s: factor * self.s, theta: self.theta }
    }

    /// The same deformation after reflection of x:
    /// W(a, s, theta; alpha) = W(a, -s, theta; pi - alpha).
    pub fn mirrored(&self) -> Self {
        Self { s: -self.s, ..*self }
    }

    /// As the array [a, s, theta].
    pub fn to_array(self) -> [f64; 3] {
        [self.a, self.s, self.theta]
    }
}

impl From<[f64; 3]> for HingeDeformation {
    fn from([a, s, theta]: [f64; 3]) -> Self {
        Self { a, s, theta }
    }
}
