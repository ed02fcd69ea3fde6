//! The optimiser: Muon for the weight matrices of the embedding, Adam for all other parameters.
//!
//! Muon steps along the orthogonal matrix nearest to the averaged gradient, so that directions in which
//! the loss is flat change as much as steep ones. In the same number of steps, the error of the forces is
//! about half of that with Adam. The damage heads overfit with Muon and are therefore trained with Adam.

use crate::config::TrainingConfig;
use burn::grad_clipping::GradientClippingConfig;
use burn::module::ParamGroup;
use burn::optim::{AdamConfig, ModuleOptimizer, MuonConfig};
use std::f64::consts::PI;

/// The optimiser of [`crate::networks::Networks`].
pub(crate) fn optimiser(config: &TrainingConfig) -> ModuleOptimizer {
    let clipping = GradientClippingConfig::Norm(config.gradient_norm_max as f32);
    AdamConfig::new()
        .with_epsilon(1e-8)
        .init()
        .with_grad_clipping(clipping.init())
        .with_group(
            ParamGroup::from_predicates(vec!["chi.", "weight"]),
            MuonConfig::new().build(),
            Some(clipping.init()),
        )
}

/// The learning rate at a step: a half cosine from `learning_rate` at the first step to `learning_rate_end` after the
/// last.
pub(crate) fn learning_rate(config: &TrainingConfig, step: usize, steps: usize) -> f64 {
    let share = 0.5 * (1.0 + (PI * step as f64 / steps as f64).cos());
    let end = config.learning_rate_end;
    end + share * (config.learning_rate - end)
}
