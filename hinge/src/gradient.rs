//! Gradients of a function of one hinge, by name: in its deformation and in its design.

use std::ops::{AddAssign, Mul};

/// Derivatives in the components of the design (7) that a sheet varies, at fixed deformation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DesignGradient {
    /// In w_lig.
    pub w_lig: f64,
    /// In alpha.
    pub alpha: f64,
    /// In rho_f, the radius of the hole over w_lig.
    pub hole: f64,
}

/// Derivatives in the deformation and in the design of a hinge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HingeGradient {
    /// In (a, s, theta).
    pub state: [f64; 3],
    /// In the design.
    pub design: DesignGradient,
}

impl DesignGradient {
    /// In (w_lig, alpha, rho_f).
    pub fn to_array(self) -> [f64; 3] {
        [self.w_lig, self.alpha, self.hole]
    }
}

impl From<[f64; 3]> for DesignGradient {
    fn from([w_lig, alpha, hole]: [f64; 3]) -> Self {
        Self { w_lig, alpha, hole }
    }
}

impl HingeGradient {
    /// In (a, s, theta, w_lig, alpha, rho_f).
    pub fn to_array(self) -> [f64; 6] {
        let ([a, s, theta], [w_lig, alpha, hole]) = (self.state, self.design.to_array());
        [a, s, theta, w_lig, alpha, hole]
    }

    /// From derivatives in the variables of a [`Jet`](crate::Jet), none of which is the cut angle.
    pub fn from_jet([a, s, theta, w_lig, hole]: [f64; 5]) -> Self {
        Self::from([a, s, theta, w_lig, 0.0, hole])
    }
}

impl From<[f64; 6]> for HingeGradient {
    fn from([a, s, theta, w_lig, alpha, hole]: [f64; 6]) -> Self {
        Self { state: [a, s, theta], design: DesignGradient { w_lig, alpha, hole } }
    }
}

impl AddAssign for DesignGradient {
    fn add_assign(&mut self, other: Self) {
        self.w_lig += other.w_lig;
        self.alpha += other.alpha;
        self.hole += other.hole;
    }
}

impl AddAssign for HingeGradient {
    fn add_assign(&mut self, other: Self) {
        std::iter::zip(&mut self.state, other.state).for_each(|(sum, part)| *sum += part);
        self.design += other.design;
    }
}

impl Mul<f64> for DesignGradient {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        self.to_array().map(|slope| factor * slope).into()
    }
}

impl Mul<f64> for HingeGradient {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        self.to_array().map(|slope| factor * slope).into()
    }
}
