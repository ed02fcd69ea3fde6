//! The loss (15), each term a mean over the batch.
//!
//! ```text
//! gamma |W - W*|^2 / W_s^2 + (1 - gamma) / 3 sum_c |F_c - F_c*|^2 / sigma_F,c^2
//!     + w_D |D - D*|^2 / D_s^2                                                     (15)
//! ```
//!
//! If D_peak is also predicted, the last term is the mean over both damage measures, and rows
//! without D_peak do not contribute to its part. A damage measure is softplus(beta y) / beta of the
//! output y of its head. With a large beta, a moderately negative y represents the zero damage of a
//! ligament before yield.

use crate::affine::{Embedding, forward, with_tangents};
use crate::config::{DAMAGE_SHARPNESS, DAMAGE_WEIGHT, ENERGY_WEIGHT};
use crate::networks::Networks;
use crate::samples::Batch;
use burn::tensor::Tensor;
use burn::tensor::activation::softplus;

/// The energy, forces and damage of (14), in the scales of (15).
pub(crate) struct Prediction {
    /// W / W_s, (n, 1)
    pub energy: Tensor<2>,
    /// (F_a, F_s, M_theta) / sigma_F, (n, 3)
    pub forces: Tensor<2>,
    /// D / D_s and, if predicted, D_peak divided by its scale, (n, 1 or 2)
    pub damage: Tensor<2>,
}

/// Evaluates the networks. W = |r|^2 with r = chi(xi) - chi(xi0), so dW/dx_k = 2 r . T_k.
pub(crate) fn predict(networks: &Networks, batch: &Batch) -> Prediction {
    let [_, n, _] = batch.states.dims();
    let Embedding { values, tangents } =
        with_tangents(&networks.chi.affine(), batch.states.clone());
    let r = values.clone().narrow(0, 1, 1) - values.narrow(0, 0, 1);
    let slopes = (r.clone() * tangents).sum_dim(2).mul_scalar(2.0);
    let heads = networks.heads();
    let damages = heads.map(|head| forward(&head.affine(), batch.deformed()));
    let damages = Tensor::cat(damages.collect(), 1);
    Prediction {
        energy: r.square().sum_dim(2).reshape([n, 1]),
        forces: slopes.reshape([3, n]).transpose() * batch.force_factors.clone(),
        damage: softplus(damages, DAMAGE_SHARPNESS),
    }
}

/// The loss (15) as a tensor with one element.
pub(crate) fn loss(networks: &Networks, batch: &Batch) -> Tensor<1> {
    let predicted = predict(networks, batch);
    let mean_square =
        |found: Tensor<2>, target: &Tensor<2>| (found - target.clone()).square().mean();
    let outputs = predicted.damage.dims()[1];
    let heads = |of: &Tensor<2>| of.clone().narrow(1, 0, outputs);
    let damage_error = (predicted.damage - heads(&batch.damage)).square();
    mean_square(predicted.energy, &batch.energy).mul_scalar(ENERGY_WEIGHT)
        + mean_square(predicted.forces, &batch.forces).mul_scalar(1.0 - ENERGY_WEIGHT)
        + (damage_error * heads(&batch.damage_weights)).mean().mul_scalar(DAMAGE_WEIGHT)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::config::TrainingConfig;
    use crate::networks::{Dense, options};
    use crate::samples::tests::samples;
    use burn::module::Param;
    use burn::tensor::{DType, TensorCreationOptions, TensorData};

    pub fn config() -> TrainingConfig {
        TrainingConfig {
            seed: 0,
            embedding: vec![8, 6, 4],
            epochs: 1,
            batch_size: 8,
            learning_rate: 1e-3,
            frozen_layers: 0,
        }
    }

    fn layer(networks: &mut Networks, head: bool, index: usize) -> &mut Dense {
        let network = if head { &mut networks.chi_d } else { &mut networks.chi };
        &mut network.layers[index]
    }

    /// An arbitrary direction with the given shape.
    fn direction(shape: [usize; 2], options: &TensorCreationOptions) -> Tensor<2> {
        let values: Vec<f64> =
            (0..shape[0] * shape[1]).map(|index| (1.1 * index as f64 + 0.4).cos()).collect();
        Tensor::from_data(TensorData::new(values, shape), options.clone())
    }

    #[test]
    fn the_parameter_gradient_agrees_with_finite_differences() {
        let options = options(DType::F64);
        let config = TrainingConfig { seed: 3, ..config() };
        let networks = Networks::new(&config, 6, true, &options);
        let batch = Batch::new(&samples(8), 6, &options);
        let gradients = loss(&networks, &batch).backward();
        let step = 1e-5;
        for (head, index) in [(false, 0), (false, 1), (false, 2), (true, 0), (true, 1)] {
            let Dense { weight, bias, .. } = layer(&mut networks.clone(), head, index).clone();
            let weight_direction = direction(weight.val().dims(), &options);
            let bias_direction = direction([1, bias.val().dims()[0]], &options).squeeze_dim(0);
            let moved = |step: f64| -> f64 {
                let mut networks = networks.clone();
                let layer = layer(&mut networks, head, index);
                let move_weight = weight_direction.clone().mul_scalar(step);
                let move_bias: Tensor<1> = bias_direction.clone().mul_scalar(step);
                layer.weight = Param::from_tensor((weight.val() + move_weight).detach());
                layer.bias = Param::from_tensor((bias.val() + move_bias).detach());
                loss(&networks, &batch).into_scalar()
            };
            let difference = (moved(step) - moved(-step)) / (2.0 * step);
            let along_weight = weight.val().grad(&gradients).unwrap() * weight_direction.inner();
            let along_bias = bias.val().grad(&gradients).unwrap() * bias_direction.inner();
            let exact: f64 =
                along_weight.sum().into_scalar::<f64>() + along_bias.sum().into_scalar::<f64>();
            assert!(
                exact.abs() > 1e-3,
                "the gradient of layer {index} is too small for this test: {exact:e}"
            );
            assert!(
                (difference - exact).abs() < 1e-8 * exact.abs().max(1.0),
                "layer {index}: {difference} and {exact}"
            );
        }
    }
}
