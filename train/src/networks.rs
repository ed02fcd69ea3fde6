//! The embedding chi and the damage head chi_D of (14) as Burn modules.

use burn::module::{Module, Param};
use burn::tensor::activation::sigmoid;
use burn::tensor::{DType, Tensor, TensorCreationOptions, TensorData};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use surrogate::Layer;

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

/// In float32, tanh x = 2 sigmoid(2 x) - 1: half the time of the backends' own, whose library call
/// does not vectorise, at an absolute error of one rounding.
pub(crate) fn tanh(x: Tensor<2>) -> Tensor<2> {
    match x.dtype() {
        DType::F32 => sigmoid(x.mul_scalar(2.0)).mul_scalar(2.0).sub_scalar(1.0),
        _ => x.tanh(),
    }
}

impl Networks {
    /// Xavier's uniform weights and zero biases. They come from our own generator, so that a seed
    /// gives the same weights on every backend.
    pub fn new(
        embedding: &[usize],
        damage: &[usize],
        damage_outputs: usize,
        seed: u64,
        options: &TensorCreationOptions,
    ) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let head: Vec<usize> = damage.iter().copied().chain([damage_outputs]).collect();
        Self {
            chi: Mlp::new(embedding, &mut rng, options),
            chi_d: Mlp::new(&head, &mut rng, options),
        }
    }

    /// Layers of a weight file.
    pub fn of_layers(chi: &[Layer], chi_d: &[Layer], options: &TensorCreationOptions) -> Self {
        let network = |layers: &[Layer]| Mlp {
            layers: layers
                .iter()
                .map(|layer| Dense::of(layer, options))
                .collect(),
        };
        Self {
            chi: network(chi),
            chi_d: network(chi_d),
        }
    }

    /// Units of each layer: of chi, and of the hidden layers of the damage head.
    pub fn widths(&self) -> [Vec<usize>; 2] {
        let units = |network: &Mlp| -> Vec<usize> {
            let layers = network.layers.iter();
            layers.map(|layer| layer.bias.val().dims()[0]).collect()
        };
        let mut damage = units(&self.chi_d);
        damage.pop();
        [units(&self.chi), damage]
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

    /// Weight files hold (outputs, inputs).
    fn of(layer: &Layer, options: &TensorCreationOptions) -> Self {
        let tensor = |tensor: &surrogate::Tensor| {
            TensorData::new(tensor.values.clone(), tensor.shape.clone())
        };
        let weight: Tensor<2> = Tensor::from_data(tensor(&layer.weight), options.clone());
        let bias = Tensor::from_data(tensor(&layer.bias), options.clone());
        Self {
            weight: Param::from_tensor(weight.transpose().detach()),
            bias: Param::from_tensor(bias),
        }
    }

    pub fn forward(&self, inputs: Tensor<2>) -> Tensor<2> {
        inputs.matmul(self.weight.val()) + self.bias.val().unsqueeze()
    }
}
