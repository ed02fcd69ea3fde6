//! D and D_peak of (14), and their gradients.
//!
//! ```text
//! D = D_s softplus(beta chi_D(xi)) / beta,   softplus(y) = log(1 + e^y)
//! ```
//!
//! D_peak has the same form, with its own network and scale.

use crate::features::{features, pull_back};
use crate::mlp_kernels::{Passes, chunk_size, filled};
use crate::network::Network;
use crate::reference_ligament;
use hinge::{HingeDeformation, HingeDesign, HingeGradient, NetLigament};
use std::iter::zip;

/// Damage measures of one hinge and their gradients.
#[derive(Clone, Copy, Debug, Default)]
pub struct HingeDamage {
    /// D, the consumed fraction of the ligament's ductility: zero in an undamaged hinge.
    pub d: f64,
    /// The gradient of D.
    pub gradient: HingeGradient,
    /// D_peak, the plastic strain of the most strained part of the ligament, divided by the
    /// fracture strain. The ligament tears at 1. `None` if the weights do not predict it.
    pub d_peak: Option<f64>,
    /// The gradient of D_peak; zero without it.
    pub peak_gradient: HingeGradient,
}

/// One damage measure of each hinge, and its gradient.
///
/// `head` has one output; `sharpness` is beta; `seen` are the hinges that the networks see, with
/// their maps. Without `with_gradient` the gradients are zero.
pub(crate) fn evaluate(
    head: &Network,
    scale: f64,
    sharpness: f64,
    seen: &[(NetLigament, HingeDesign, HingeDeformation)],
    with_gradient: bool,
) -> Vec<(f64, HingeGradient)> {
    let size = chunk_size(seen.len(), 0);
    let mut damages = Vec::with_capacity(seen.len());
    Passes::lent(|passes| {
        for seen in seen.chunks(size) {
            let xi = filled(seen.iter().map(|(_, g, eps)| features(g, eps)));
            passes.forward(head, &xi, 0..0);
            let outputs = passes.outputs().flatten();
            let outputs: Vec<f64> = outputs.map(|&y| sharpness * y).collect();
            let value = |y: f64| scale / sharpness * softplus(y);
            if !with_gradient {
                let values = zip(seen, outputs).map(|(_, y)| (value(y), HingeGradient::default()));
                damages.extend(values);
                continue;
            }
            let slopes: Vec<f64> = outputs.iter().map(|&y| logistic(y)).collect();
            passes.reverse(head, &slopes, &mut []);
            damages.extend(seen.iter().zip(outputs).enumerate().map(
                |(hinge, ((ligament, g, eps), y))| {
                    let gradient = passes.gradient(hinge).map(|slope| scale * slope);
                    let seen = pull_back(gradient, g, eps);
                    (value(y), reference_ligament::gradient(ligament, seen, eps.theta))
                },
            ));
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
