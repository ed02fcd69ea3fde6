//! The optimiser: Muon for the weight matrices of the embedding, Adam for all other parameters.
//!
//! Muon steps along the orthogonal matrix nearest to the averaged gradient, so directions in
//! which the loss is flat change as much as steep ones. In the same number of steps, the error of
//! the forces is about half of that with Adam. The damage heads overfit with Muon and are therefore
//! trained with Adam.

use burn::grad_clipping::GradientClippingConfig;
use burn::module::ParamGroup;
use burn::optim::{AdamConfig, ModuleOptimizer, MuonConfig};
use std::f64::consts::PI;

/// Maximum norm of the gradient of one weight matrix or bias; larger gradients are scaled down to
/// it.
const GRADIENT_NORM_MAX: f32 = 1.0;

/// The optimiser of [`crate::networks::Networks`].
pub(crate) fn optimiser() -> ModuleOptimizer {
    let clipping = GradientClippingConfig::Norm(GRADIENT_NORM_MAX);
    AdamConfig::new().with_epsilon(1e-8).init().with_grad_clipping(clipping.init()).with_group(
        ParamGroup::from_predicates(vec!["chi.", "weight"]),
        MuonConfig::new().build(),
        Some(clipping.init()),
    )
}

/// The learning rate at a step: a half cosine from `initial` at the first step to zero after the
/// last.
pub(crate) fn learning_rate(initial: f64, step: usize, steps: usize) -> f64 {
    0.5 * (1.0 + (PI * step as f64 / steps as f64).cos()) * initial
}
