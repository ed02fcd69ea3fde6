//! One layer of a network, and tanh networks of them.

use burn::tensor::Tensor;
use surrogate::tanh_in_place;

/// A layer as it is evaluated: y = x W + b.
#[derive(Clone, Debug)]
pub(crate) struct Affine {
    /// (inputs, outputs)
    pub weight: Tensor<2>,
    pub bias: Tensor<1>,
}

impl Affine {
    pub fn forward(&self, inputs: Tensor<2>) -> Tensor<2> {
        inputs.matmul(self.weight.clone()) + self.bias.clone().unsqueeze()
    }
}

/// The values of a network; [`crate::force_tangents`] has the derivatives too.
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

/// tanh; in float32 by the kernel's function, the backends' own library call being several times
/// slower.
///
/// Burn does not see that function: y + (1 - y^2) (x - x_0), of which only x is differentiated and
/// x_0 is equal to it, has the value and the derivative of tanh x.
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
