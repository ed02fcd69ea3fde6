//! D of (14), its peak, and their gradients in the hinge deformation and in (w_lig, alpha).
//!
//! ```text
//! (D, D_peak) = (D_s, D_peak,s) softplus(chi_D(xi)),   softplus(y) = log(1 + e^y)
//! ```

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
    /// `None` from weights of format version 1, whose head does not predict it.
    pub d_peak: Option<f64>,
    /// dD_peak/d(a, s, theta, w_lig, alpha); zero where there is no D_peak.
    pub peak_gradient: [f64; FEATURES],
}

/// See [`crate::Surrogate::damage`]; one scale for each output of `chi_d`.
pub(crate) fn evaluate(
    chi_d: &Network,
    scales: &[f64],
    designs: &[HingeDesign],
    deformations: &[HingeDeformation],
) -> Vec<HingeDamage> {
    assert_eq!(
        designs.len(),
        deformations.len(),
        "one deformation for each hinge"
    );
    let mut damages = vec![HingeDamage::default(); designs.len()];
    let size = chunk_size(designs.len(), 0);
    let states = designs.chunks(size).zip(deformations.chunks(size));
    Passes::lent(|passes| {
        for (damages, (designs, deformations)) in damages.chunks_mut(size).zip(states) {
            let states = || designs.iter().zip(deformations);
            let xi: Vec<_> = states().map(|(g, eps)| features(g, eps)).collect();
            passes.forward(chi_d, &xi, 0..0);
            for (output, &scale) in scales.iter().enumerate() {
                let values = differentiate(passes, chi_d, output);
                for ((damage, (g, eps)), (hinge, value)) in damages
                    .iter_mut()
                    .zip(states())
                    .zip(values.iter().enumerate())
                {
                    let gradient = passes.gradient(hinge).map(|slope| scale * slope);
                    let gradient = pull_back(gradient, g, eps);
                    match output {
                        0 => (damage.d, damage.gradient) = (scale * value, gradient),
                        _ => {
                            damage.d_peak = Some(scale * value);
                            damage.peak_gradient = gradient;
                        }
                    }
                }
            }
        }
    });
    damages
}

/// The softplus of one output for each hinge of the chunk, leaving its gradient in `passes`.
fn differentiate(passes: &mut Passes, chi_d: &Network, output: usize) -> Vec<f64> {
    let mut seed = Vec::new();
    let mut values = Vec::new();
    for (index, block) in passes.outputs().enumerate() {
        if index == output {
            seed.extend(block.iter().map(|&y| logistic(y)));
            values.extend(block.iter().map(|&y| softplus(y)));
        } else {
            seed.extend(block.iter().map(|_| 0.0));
        }
    }
    passes.reverse(chi_d, &seed, &mut []);
    values
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
