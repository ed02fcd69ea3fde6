//! D of (14), its peak, and their gradients in the hinge deformation and in (w_lig, alpha).
//!
//! ```text
//! D = D_s softplus(beta chi_D(xi)) / beta,   softplus(y) = log(1 + e^y)
//! ```
//!
//! and D_peak likewise, with a network and a scale of its own.

use crate::features::{FEATURES, features, pull_back};
use crate::network::Network;
use crate::passes::{Passes, chunk_size};
use hinge::{HingeDeformation, HingeDesign};

/// Damage of one hinge and its gradient.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HingeDamage {
    /// D, the share of the ligament's ductility that is used up: zero in a pristine hinge.
    pub d: f64,
    /// dD/d(a, s, theta, w_lig, alpha).
    pub gradient: [f64; FEATURES],
    /// D_peak, the plastic strain where it is greatest over that at fracture: at one it tears.
    /// `None` from weights that do not predict it.
    pub d_peak: Option<f64>,
    /// dD_peak/d(a, s, theta, w_lig, alpha); zero where there is no D_peak.
    pub peak_gradient: [f64; FEATURES],
}

/// One damage and its gradient in (a, s, theta, w_lig, alpha), of each hinge.
///
/// `head` has one output; `sharpness` is beta.
pub(crate) fn evaluate(
    head: &Network,
    scale: f64,
    sharpness: f64,
    designs: &[HingeDesign],
    deformations: &[HingeDeformation],
) -> Vec<(f64, [f64; FEATURES])> {
    let size = chunk_size(designs.len(), 0);
    let mut damages = Vec::with_capacity(designs.len());
    Passes::lent(|passes| {
        for (designs, deformations) in designs.chunks(size).zip(deformations.chunks(size)) {
            let states = || designs.iter().zip(deformations);
            let xi: Vec<_> = states().map(|(g, eps)| features(g, eps)).collect();
            passes.forward(head, &xi, 0..0);
            let outputs = passes.outputs().flatten();
            let outputs: Vec<f64> = outputs.map(|&y| sharpness * y).collect();
            let slopes: Vec<f64> = outputs.iter().map(|&y| logistic(y)).collect();
            passes.reverse(head, &slopes, &mut []);
            damages.extend(
                states()
                    .zip(outputs)
                    .enumerate()
                    .map(|(hinge, ((g, eps), y))| {
                        let gradient = passes.gradient(hinge).map(|slope| scale * slope);
                        (scale / sharpness * softplus(y), pull_back(gradient, g, eps))
                    }),
            );
        }
    });
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
