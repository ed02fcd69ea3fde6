//! One layer of a network, and tanh networks of layers.

use burn::tensor::Tensor;
use surrogate::tanh_in_place;

/// A layer as evaluated: y = x W + b.
#[derive(Clone, Debug)]
pub(crate) struct Affine {
    /// (inputs, outputs)
    pub weight: Tensor<2>,
    pub bias: Tensor<1>,
}

impl Affine {
    pub(crate) fn forward(&self, inputs: Tensor<2>) -> Tensor<2> {
        inputs.matmul(self.weight.clone()) + self.bias.clone().unsqueeze()
    }
}

/// The outputs of a network; [`crate::force_tangents`] also computes derivatives.
pub(crate) fn forward(layers: &[Affine], inputs: Tensor<2>) -> Tensor<2> {
    let mut values = inputs;
    for (index, layer) in layers.iter().enumerate() {
        if index > 0 {
            values = tanh(values);
        }
        values = layer.forward(values);
    }
    values
}

/// tanh. In float32 it is computed by [`tanh_in_place`], because the library call of the backends
/// is several times slower.
///
/// Burn cannot differentiate that function. The result is therefore y + (1 - y^2) (x - x_0), where
/// x_0 equals x but is not differentiated; it has the value and the derivative of tanh x.
pub(crate) fn tanh<const D: usize>(x: Tensor<D>) -> Tensor<D> {
    let at = x.clone().detach();
    let mut data = at.clone().into_data();
    let Ok(values) = data.as_mut_slice::<f32>() else {
        return x.tanh();
    };
    tanh_in_place(values);
    let y: Tensor<D> = Tensor::from_data(data, (&x.device(), x.dtype()));
    let slope = (y.clone() * y.clone()).neg().add_scalar(1.0);
    y + slope * (x - at)
}
