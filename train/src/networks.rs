//! The embedding chi and the damage heads chi_D and chi_P of (14) as Burn modules.

use crate::affine::Affine;
use crate::config::TrainingConfig;
use crate::mirror::Fold;
use burn::module::{Module, Param};
use burn::tensor::{DType, Device, Tensor, TensorCreationOptions, TensorData};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use surrogate::{Layer, Layers};

/// The networks have no common layers: D_peak, which has more scatter, would otherwise cause the
/// network of D to overfit.
#[derive(Module, Debug)]
pub(crate) struct Networks {
    pub chi: Mlp,
    pub chi_d: Mlp,
    pub chi_p: Option<Mlp>,
}

/// y = tanh(... tanh(x W_0 + b_0) ...) W_L + b_L
#[derive(Module, Debug)]
pub(crate) struct Mlp {
    pub layers: Vec<Dense>,
}

/// The trained half of a layer, which determines the layer by mirror symmetry.
#[derive(Module, Debug)]
pub(crate) struct Dense {
    pub weight: Param<Tensor<2>>,
    pub bias: Param<Tensor<1>>,
    #[module(skip)]
    fold: Fold,
}

/// Tensors of a number type on the processor, recording gradients: of Burn's backend flex, or of
/// the slower ndarray in a build with that feature.
pub(crate) fn options(dtype: DType) -> TensorCreationOptions {
    #[cfg(not(feature = "ndarray"))]
    let device = Device::flex();
    #[cfg(feature = "ndarray")]
    #[expect(deprecated, reason = "Burn recommends flex; both can be compared")]
    let device = Device::ndarray();
    TensorCreationOptions::new(device.autodiff()).with_dtype(dtype)
}

impl Networks {
    /// Initial networks with Xavier's uniform weights and zero biases. The random numbers do not
    /// come from the backend, so a seed gives the same weights on every backend.
    pub(crate) fn new(
        config: &TrainingConfig,
        features: usize,
        with_peak: bool,
        options: &TensorCreationOptions,
    ) -> Self {
        let embedding = &config.embedding;
        let mut rng = ChaCha8Rng::seed_from_u64(config.seed);
        let [first, second] = config.damage();
        let head = [first, second, 1];
        let mut network = |widths: &[usize], folds: Vec<Fold>| {
            let inputs = std::iter::once(features).chain(widths.iter().copied());
            let layers = inputs.zip(widths).zip(folds).map(|((inputs, &outputs), fold)| {
                Dense::new([inputs, outputs], fold, &mut rng, options)
            });
            Mlp { layers: layers.collect() }
        };
        Self {
            chi: network(embedding, folds(embedding.len())),
            chi_d: network(&head, head_folds(head.len())),
            chi_p: with_peak.then(|| network(&head, head_folds(head.len()))),
        }
    }

    /// The networks of a weight file.
    pub(crate) fn from_layers(layers: &Layers, options: &TensorCreationOptions) -> Self {
        let network = |layers: &[Layer], folds: Vec<Fold>| {
            let layers = layers.iter().zip(folds);
            Mlp {
                layers: layers
                    .map(|(layer, fold)| Dense::from_layer(layer, fold, options))
                    .collect(),
            }
        };
        let head = |layers: &[Layer]| network(layers, head_folds(layers.len()));
        let Layers { chi, chi_d, chi_p } = layers;
        Self {
            chi: network(chi, folds(chi.len())),
            chi_d: head(chi_d),
            chi_p: chi_p.as_deref().map(head),
        }
    }

    /// The same networks, the first `layers` layers of each of which no optimiser step changes.
    pub(crate) fn frozen(self, layers: usize) -> Self {
        let freeze = |mut network: Mlp| {
            let freeze = |(index, layer): (usize, Dense)| {
                if index < layers { layer.no_grad() } else { layer }
            };
            network.layers = network.layers.into_iter().enumerate().map(freeze).collect();
            network
        };
        Self { chi: freeze(self.chi), chi_d: freeze(self.chi_d), chi_p: self.chi_p.map(freeze) }
    }

    /// The damage heads.
    pub(crate) fn heads(&self) -> impl Iterator<Item = &Mlp> {
        std::iter::once(&self.chi_d).chain(&self.chi_p)
    }
}

/// The folds of the layers of chi.
fn folds(layers: usize) -> Vec<Fold> {
    let mut folds = vec![Fold::Hidden; layers];
    folds[..1].fill(Fold::First);
    folds
}

/// The folds of the layers of a damage head, whose output is not a pair.
fn head_folds(layers: usize) -> Vec<Fold> {
    let mut folds = folds(layers);
    folds[layers - 1..].fill(Fold::Invariant);
    folds
}

impl Mlp {
    /// The layers as evaluated.
    pub(crate) fn affine(&self) -> Vec<Affine> {
        self.layers.iter().map(Dense::affine).collect()
    }
}

impl Dense {
    fn new(
        [inputs, outputs]: [usize; 2],
        fold: Fold,
        rng: &mut ChaCha8Rng,
        options: &TensorCreationOptions,
    ) -> Self {
        let bound = (6.0 / (inputs + outputs) as f64).sqrt();
        let [inputs, outputs] = fold.shape([inputs, outputs]);
        let weights = (0..inputs * outputs).map(|_| rng.random_range(-bound..bound));
        let weights = TensorData::new(weights.collect::<Vec<f64>>(), [inputs, outputs]);
        Self {
            weight: Param::from_tensor(Tensor::from_data(weights, options.clone())),
            bias: Param::from_tensor(Tensor::zeros([outputs], options.clone())),
            fold,
        }
    }

    /// The trained part of a layer of a weight file, whose weight is (outputs, inputs).
    fn from_layer(layer: &Layer, fold: Fold, options: &TensorCreationOptions) -> Self {
        let tensor = |tensor: &surrogate::Tensor| {
            TensorData::new(tensor.values.clone(), tensor.shape.clone())
        };
        let weight: Tensor<2> = Tensor::from_data(tensor(&layer.weight), options.clone());
        let Affine { weight, bias } = fold.fold(Affine {
            weight: weight.transpose(),
            bias: Tensor::from_data(tensor(&layer.bias), options.clone()),
        });
        Self {
            weight: Param::from_tensor(weight.detach()),
            bias: Param::from_tensor(bias.detach()),
            fold,
        }
    }

    fn affine(&self) -> Affine {
        self.fold.unfold(Affine { weight: self.weight.val(), bias: self.bias.val() })
    }
}
