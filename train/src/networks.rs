//! The embedding chi and the damage head chi_D of (14) as Burn modules.

use burn::module::{Module, Param};
use burn::tensor::activation::tanh;
use burn::tensor::{Tensor, TensorCreationOptions, TensorData};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// The features of (13).
const INPUTS: usize = 5;

/// Both networks; they share nothing but their inputs.
#[derive(Module, Debug)]
pub(crate) struct Networks {
    pub chi: Mlp,
    pub chi_d: Mlp,
}

/// y = tanh(... tanh(x W_0 + b_0) ...) W_L + b_L
#[derive(Module, Debug)]
pub(crate) struct Mlp {
    pub layers: Vec<Dense>,
}

/// y = x W + b
#[derive(Module, Debug)]
pub(crate) struct Dense {
    /// (inputs, outputs)
    pub weight: Param<Tensor<2>>,
    pub bias: Param<Tensor<1>>,
}

impl Networks {
    /// Xavier's uniform weights and zero biases. They come from our own generator, so that a seed
    /// gives the same weights on every backend.
    pub fn new(
        embedding: &[usize],
        damage: &[usize],
        seed: u64,
        options: &TensorCreationOptions,
    ) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let head: Vec<usize> = damage.iter().copied().chain([1]).collect();
        Self {
            chi: Mlp::new(embedding, &mut rng, options),
            chi_d: Mlp::new(&head, &mut rng, options),
        }
    }
}

impl Mlp {
    fn new(widths: &[usize], rng: &mut ChaCha8Rng, options: &TensorCreationOptions) -> Self {
        let inputs = std::iter::once(INPUTS).chain(widths.iter().copied());
        let layers = inputs
            .zip(widths)
            .map(|(inputs, &outputs)| Dense::new(inputs, outputs, rng, options))
            .collect();
        Self { layers }
    }

    /// Values alone; [`crate::force_tangents`] has the derivatives too.
    pub fn forward(&self, inputs: Tensor<2>) -> Tensor<2> {
        let mut values = inputs;
        for (index, layer) in self.layers.iter().enumerate() {
            if index > 0 {
                values = tanh(values);
            }
            values = layer.forward(values);
        }
        values
    }
}

impl Dense {
    fn new(
        inputs: usize,
        outputs: usize,
        rng: &mut ChaCha8Rng,
        options: &TensorCreationOptions,
    ) -> Self {
        let bound = (6.0 / (inputs + outputs) as f64).sqrt();
        let weights = (0..inputs * outputs).map(|_| rng.random_range(-bound..bound));
        let weights = TensorData::new(weights.collect::<Vec<f64>>(), [inputs, outputs]);
        Self {
            weight: Param::from_tensor(Tensor::from_data(weights, options.clone())),
            bias: Param::from_tensor(Tensor::zeros([outputs], options.clone())),
        }
    }

    pub fn forward(&self, inputs: Tensor<2>) -> Tensor<2> {
        inputs.matmul(self.weight.val()) + self.bias.val().unsqueeze()
    }
}
