//! chi with its derivatives in the standardised (eta_a, eta_s, theta), pushed forward.
//!
//! ```text
//! a_0 = x W_0 + b_0          T_0,k = row k of W_0
//! a_l = tanh(a_{l-1}) W_l + b_l,   T_l,k = ((1 - tanh(a_{l-1})^2) T_{l-1,k}) W_l
//! ```
//!
//! Every line is an ordinary tensor operation, so one reverse pass through them gives the
//! parameter gradient of a loss in the forces.

use crate::networks::{Mlp, tanh};
use burn::tensor::Tensor;

/// The values of `network` and its derivatives in the first three inputs, each (n, outputs).
pub(crate) fn with_tangents(network: &Mlp, inputs: Tensor<2>) -> (Tensor<2>, [Tensor<2>; 3]) {
    let (first, following) = network
        .layers
        .split_first()
        .expect("the configuration asks for a layer or more");
    let rows = inputs.dims()[0] as i64;
    let mut values = first.forward(inputs);
    let mut tangents = [0, 1, 2].map(|k| {
        let row = first.weight.val().narrow(0, k, 1);
        row.expand([rows, -1])
    });
    for layer in following {
        let activation = tanh(values);
        let slope = activation.clone().square().neg().add_scalar(1.0);
        tangents = tangents.map(|tangent| (slope.clone() * tangent).matmul(layer.weight.val()));
        values = layer.forward(activation);
    }
    (values, tangents)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::Backend;
    use crate::networks::Networks;
    use crate::samples::Batch;
    use crate::samples::tests::samples;
    use burn::tensor::{DType, TensorCreationOptions};

    #[test]
    fn tangents_are_those_of_finite_differences() {
        let step = 1e-5;
        for &backend in Backend::ALL {
            let options = TensorCreationOptions::new(backend.device()).with_dtype(DType::F64);
            let network = Networks::new(&[9, 8, 4], &[3], 1, 5, &options).chi;
            let (_, tangents) = with_tangents(&network, Batch::new(&samples(6), &options).inputs);
            for (k, tangent) in tangents.into_iter().enumerate() {
                let moved = |step: f64| {
                    let mut samples = samples(6);
                    samples
                        .iter_mut()
                        .for_each(|sample| sample.inputs[k] += step);
                    network.forward(Batch::new(&samples, &options).inputs)
                };
                let difference = (moved(step) - moved(-step)).div_scalar(2.0 * step);
                let error: f64 = (difference - tangent).abs().max().into_scalar();
                assert!(error < 1e-9, "{backend}, input {k}: {error:e}");
            }
        }
    }
}
