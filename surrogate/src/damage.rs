//! D of (14) and its gradient in the hinge deformation and in (w_lig, alpha).
//!
//! ```text
//! D = D_s softplus(chi_D(xi)),   softplus(y) = log(1 + e^y)
//! ```

use crate::features::{FEATURES, features, pull_back};
use crate::network::Network;
use crate::passes::{CHUNK, Passes};
use hinge::{HingeDeformation, HingeDesign};

/// Damage of one hinge and its gradient.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HingeDamage {
    /// D: zero in a pristine hinge, one at fracture.
    pub d: f64,
    /// dD/d(a, s, theta, w_lig, alpha).
    pub gradient: [f64; FEATURES],
}

/// See [`crate::Surrogate::damage`].
pub(crate) fn evaluate(
    chi_d: &Network,
    damage_scale: f64,
    designs: &[HingeDesign],
    deformations: &[HingeDeformation],
) -> Vec<HingeDamage> {
    assert_eq!(
        designs.len(),
        deformations.len(),
        "one deformation for each hinge"
    );
    let mut passes = Passes::default();
    let mut damages = Vec::with_capacity(designs.len());
    for (designs, deformations) in designs.chunks(CHUNK).zip(deformations.chunks(CHUNK)) {
        let states = || designs.iter().zip(deformations);
        let xi: Vec<_> = states().map(|(g, eps)| features(g, eps)).collect();
        passes.forward(chi_d, &xi, 0..0);
        let outputs: Vec<f64> = passes.outputs().flatten().copied().collect();
        let slopes: Vec<f64> = outputs.iter().map(|&y| logistic(y)).collect();
        passes.reverse(chi_d, &slopes, &mut []);
        for (hinge, (design, deformation)) in states().enumerate() {
            let gradient = passes.gradient(hinge).map(|value| damage_scale * value);
            damages.push(HingeDamage {
                d: damage_scale * softplus(outputs[hinge]),
                gradient: pull_back(gradient, design, deformation),
            });
        }
    }
    damages
}

/// log(1 + e^y) without overflow.
fn softplus(y: f64) -> f64 {
    y.max(0.0) + (-y.abs()).exp().ln_1p()
}

/// The derivative of [`softplus`].
fn logistic(y: f64) -> f64 {
    1.0 / (1.0 + (-y).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn softplus_is_smooth_positive_and_finite() {
        assert_eq!(softplus(0.0), std::f64::consts::LN_2);
        assert_eq!(softplus(1000.0), 1000.0);
        assert!(softplus(-700.0) > 0.0);
        let h = 1e-6;
        for y in [-30.0, -2.0, 0.0, 0.5, 20.0] {
            let difference = (softplus(y + h) - softplus(y - h)) / (2.0 * h);
            assert!((difference - logistic(y)).abs() < 1e-8, "y = {y}");
        }
        assert_eq!((logistic(-1000.0), logistic(1000.0)), (0.0, 1.0));
    }
}
