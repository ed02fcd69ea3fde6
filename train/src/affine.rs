//! One layer of a network, and tanh networks of layers.

use burn::tensor::{Tensor, TensorData};
use std::f64::consts::FRAC_PI_2;
use surrogate::{Standardisation, tanh_in_place};

/// A layer as evaluated: y = x W + b.
#[derive(Debug)]
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

/// The outputs of a network; [`crate::affine`] also computes derivatives.
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

// chi with its derivatives in the standardised (eta_a, eta_s, theta), by forward differentiation.
//
// ```text
// a_0 = x W_0 + b_0          T_0,k = row k of W_0
// a_l = tanh(a_{l-1}) W_l + b_l,   T_l,k = ((1 - tanh(a_{l-1})^2) T_{l-1,k}) W_l
// ```
//
// All lines are ordinary tensor operations, so one reverse pass gives the parameter gradient
// of a loss that contains forces. The undeformed states, the deformed states and the three
// tangents are multiplied by each layer's weight in one matrix product.

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

// Mirror symmetry by construction, instead of learned from mirror images.
//
// W(a, s, theta; alpha) = W(a, -s, theta; pi - alpha) is W(x) = W(S x) in standardised features,
// with S = diag(1, -1, 1, 1, -1, 1) if the means of eta_s and alpha are 0 and pi / 2. The units of
// each layer form pairs (j, n - 1 - j). One unit of a pair has the value of the other unit at the
// mirror image:
//
// ```text
// h_{n-1-j}(x) = h_j(S x)      if  W_0 = [A, S A R],  W_l = [A, R A R],  b_l = [b, R b]
// ```
//
// with R the reversal of order. Only the halves A and b are trained. |chi - chi_0|^2 is invariant
// because it is symmetric in the units of a pair; the output of a damage head is invariant with
// W_L = [B; R B].

/// The diagonal of S. Only weights for several radii have the last feature, the radius of the hole.
const SIGNS: [f64; 6] = [1.0, -1.0, 1.0, 1.0, -1.0, 1.0];

/// Positions of the features that change their sign.
const ETA_S: usize = 1;
const ALPHA: usize = 4;

/// How a layer is determined by its trained part.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Fold {
    /// The inputs are features; half of the columns are trained.
    First,
    /// The inputs and outputs are pairs; half of the columns are trained.
    Hidden,
    /// The inputs are pairs, the outputs are invariant; half of the rows are trained.
    Invariant,
}

impl Fold {
    /// (inputs, outputs) of the trained part of a layer of this shape.
    pub(crate) fn shape(self, [inputs, outputs]: [usize; 2]) -> [usize; 2] {
        match self {
            Self::First | Self::Hidden => [inputs, outputs / 2],
            Self::Invariant => [inputs / 2, outputs],
        }
    }

    /// The whole layer with the trained part `part`.
    pub(crate) fn unfold(self, part: Affine) -> Affine {
        let Affine { weight, bias } = part;
        let paired = |bias: Tensor<1>| Tensor::cat(vec![bias.clone(), bias.flip([0])], 0);
        match self {
            Self::First => {
                let options = (&weight.device(), weight.dtype());
                let [features, _] = weight.dims();
                let signs = TensorData::new(SIGNS[..features].to_vec(), [features, 1]);
                let signs: Tensor<2> = Tensor::from_data(signs, options);
                let images = (weight.clone() * signs).flip([1]);
                Affine { weight: Tensor::cat(vec![weight, images], 1), bias: paired(bias) }
            }
            Self::Hidden => Affine {
                weight: Tensor::cat(vec![weight.clone(), weight.flip([0, 1])], 1),
                bias: paired(bias),
            },
            Self::Invariant => {
                Affine { weight: Tensor::cat(vec![weight.clone(), weight.flip([0])], 0), bias }
            }
        }
    }

    /// The trained part of a whole layer.
    pub(crate) fn fold(self, whole: Affine) -> Affine {
        let Affine { weight, bias } = whole;
        let [inputs, outputs] = self.shape(weight.dims());
        Affine {
            weight: weight.narrow(0, 0, inputs).narrow(1, 0, outputs),
            bias: bias.narrow(0, 0, outputs),
        }
    }
}

/// Whether the mirror image of standardised features x is S x.
pub(crate) fn is_centred(standardisation: &Standardisation) -> bool {
    standardisation.mean[ETA_S] == 0.0 && standardisation.mean[ALPHA] == FRAC_PI_2
}

/// Sets the means of eta_s and alpha of rows with their mirror images to their exact values, so
/// that the mirror image of standardised features x is S x.
pub(crate) fn centre(standardisation: &mut Standardisation) {
    standardisation.mean[ETA_S] = 0.0;
    standardisation.mean[ALPHA] = FRAC_PI_2;
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
