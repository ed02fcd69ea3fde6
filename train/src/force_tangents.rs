//! chi with its derivatives in the standardised (eta_a, eta_s, theta), by forward differentiation.
//!
//! ```text
//! a_0 = x W_0 + b_0          T_0,k = row k of W_0
//! a_l = tanh(a_{l-1}) W_l + b_l,   T_l,k = ((1 - tanh(a_{l-1})^2) T_{l-1,k}) W_l
//! ```
//!
//! All lines are ordinary tensor operations, so one reverse pass gives the parameter gradient
//! of a loss that contains forces. The undeformed states, the deformed states and the three
//! tangents are multiplied by each layer's weight in one matrix product.

use crate::affine::{Affine, tanh};
use burn::tensor::Tensor;

/// chi and its tangents for a batch of hinges.
pub(crate) struct Embedding {
    /// chi at the undeformed and at the deformed states, (2, n, outputs).
    pub values: Tensor<3>,
    /// Derivatives of chi at the deformed states in the first three inputs, (3, n, outputs).
    pub tangents: Tensor<3>,
}

/// Evaluates chi and its tangents. `inputs` are the inputs at the undeformed and at the deformed
/// states, (2, n, features).
pub(crate) fn with_tangents(layers: &[Affine], inputs: Tensor<3>) -> Embedding {
    let (first, following) =
        layers.split_first().expect("a valid configuration has at least one layer");
    let [_, n, features] = inputs.dims();
    let inputs = inputs.reshape([2 * n, features]);
    let values = first.forward(inputs);
    let mut values = values.clone().reshape([2, n, values.dims()[1]]);
    let mut tangents = first.weight.clone().narrow(0, 0, 3).unsqueeze_dim::<3>(1);
    for layer in following {
        let activation = tanh(values);
        let slope = activation.clone().narrow(0, 1, 1).square().neg().add_scalar(1.0);
        let block = Tensor::cat(vec![activation, slope * tangents], 0);
        let [blocks, _, units] = block.dims();
        let product = block.reshape([blocks * n, units]).matmul(layer.weight.clone());
        let outputs = product.dims()[1];
        let product = product.reshape([blocks, n, outputs]);
        values = product.clone().narrow(0, 0, 2) + layer.bias.clone().unsqueeze();
        tangents = product.narrow(0, 2, 3);
    }
    Embedding { values, tangents }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::affine::forward;
    use crate::config::TrainingConfig;
    use crate::loss::tests::config;
    use crate::networks::{Networks, options};
    use crate::samples::tests::samples;
    use crate::samples::{Batch, Sample};
    use burn::tensor::DType;

    #[test]
    fn tangents_agree_with_finite_differences() {
        let step = 1e-5;
        let options = options(DType::F64);
        for features in [5, 6] {
            let config = TrainingConfig { seed: 5, ..config() };
            let chi = Networks::new(&config, features, true, &options).chi;
            let layers = chi.affine();
            let batch = |samples: &[Sample]| Batch::new(samples, features, &options);
            let embedding = with_tangents(&layers, batch(&samples(6)).states);
            for k in 0..3 {
                let moved = |step: f64| {
                    let mut samples = samples(6);
                    samples.iter_mut().for_each(|sample| sample.inputs[k] += step);
                    forward(&layers, batch(&samples).deformed())
                };
                let difference = (moved(step) - moved(-step)).div_scalar(2.0 * step);
                let tangent = embedding.tangents.clone().narrow(0, k, 1).squeeze_dim(0);
                let error: f64 = (difference - tangent).abs().max().into_scalar();
                assert!(error < 1e-9, "input {k}: {error:e}");
            }
        }
    }
}
