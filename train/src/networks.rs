//! The embedding chi and the damage heads chi_D and chi_P of (14) as Burn modules.

use crate::affine::{Affine, Fold};
use crate::config::TrainingConfig;
use burn::module::{Module, Param};
use burn::tensor::{DType, Device, Tensor, TensorCreationOptions, TensorData, TensorReadError};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use support::{Fault, fault};
use surrogate::{DenseLayer, Layers};

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
        let network = |layers: &[DenseLayer], folds: Vec<Fold>| {
            let layers = layers.iter().zip(folds);
            Mlp {
                layers: layers
                    .map(|(layer, fold)| Dense::from_layer(layer, fold, options))
                    .collect(),
            }
        };
        let head = |layers: &[DenseLayer]| network(layers, head_folds(layers.len()));
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
    fn from_layer(layer: &DenseLayer, fold: Fold, options: &TensorCreationOptions) -> Self {
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

// Conversion of Burn's networks to the layers of a weight file.

/// The layers in float64, with weights as (outputs, inputs).
pub(crate) fn layers(networks: &Networks) -> Result<Layers, Fault> {
    let layers = |network: &Mlp| network.affine().into_iter().map(layer).collect();
    Ok(Layers {
        chi: layers(&networks.chi)?,
        chi_d: layers(&networks.chi_d)?,
        chi_p: networks.chi_p.as_ref().map(layers).transpose()?,
    })
}

/// The fault of a tensor that the backend does not return.
pub(crate) fn unread(error: TensorReadError) -> Fault {
    fault!("a tensor cannot be read from the backend: {error}")
}

fn layer(affine: Affine) -> Result<DenseLayer, Fault> {
    let weight = affine.weight.inner().transpose();
    let bias = affine.bias.inner();
    Ok(DenseLayer {
        weight: surrogate::Tensor {
            shape: weight.dims().to_vec(),
            values: weight.try_into_vec_as().map_err(unread)?,
        },
        bias: surrogate::Tensor {
            shape: bias.dims().to_vec(),
            values: bias.try_into_vec_as().map_err(unread)?,
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{DAMAGE_SHARPNESS, TrainingConfig};
    use crate::loss::predict;
    use crate::loss::tests::config;
    use crate::networks::options;
    use crate::samples::{Batch, Scales};
    use crate::validation::Parity;
    use burn::tensor::DType;
    use dataset::SolvedRay;
    use hinge::{HingeConstants, HingeDeformation, HingeSample, NetLigament, TrainingDomain};
    use surrogate::{
        Card, FEATURE_NAMES, FORMAT_VERSION, Surrogate, TestErrors, UNITS, feature_names,
    };

    /// A ray of one sample.
    fn ray(index: usize) -> SolvedRay {
        let wave = |speed: f64| (speed * index as f64 + 0.3).sin();
        SolvedRay {
            job: format!("{index}"),
            design: HingeConstants::PAPER.hinge(15.0 + 9.0 * wave(1.3), 1.5 + 0.7 * wave(2.9)),
            samples: vec![HingeSample {
                a: 2.0 * wave(0.7),
                s: 2.0 * wave(1.9),
                theta: 0.6 + 0.6 * wave(3.1),
                w: 50.0,
                f_a: 10.0,
                f_s: 5.0,
                m_theta: 80.0,
                d: 0.01,
                d_peak: Some(0.2),
                ..HingeSample::default()
            }],
            ..SolvedRay::default()
        }
    }

    fn surrogate(networks: &Networks, scales: &Scales) -> Surrogate {
        let flat = (HingeConstants::PAPER.hinge(1.0, 1.0), HingeDeformation::default());
        let mut domain = TrainingDomain::covering([flat]).unwrap();
        domain.holes = (scales.features() == FEATURE_NAMES.len()).then_some([0.05, 0.35]);
        let card = Card {
            format_version: FORMAT_VERSION,
            weights_hash: None,
            units: UNITS.into(),
            features: FEATURE_NAMES[..scales.features()].iter().map(ToString::to_string).collect(),
            standardisation: scales.standardisation.clone(),
            energy_scale: scales.energy,
            damage_scale: scales.damage,
            peak_scale: scales.peak,
            damage_sharpness: DAMAGE_SHARPNESS,
            fine_tuned_from: None,
            distillation: None,
            domain,
            hinge: HingeConstants::PAPER,
            material: String::new(),
            material_hash: None,
            settings_hash: None,
            tier: String::new(),
            bent_rays: false,
            dataset_hash: String::new(),
            split_hash: String::new(),
            training: serde_json::Value::Null,
            training_rays: None,
            training_s: None,
            test_errors: TestErrors::default(),
            spot_check: None,
            visited: None,
        };
        Surrogate::from_parts(layers(networks).unwrap(), card).unwrap()
    }

    /// |burn - kernel| / |kernel| over all states, for W, F_a, F_s, M_theta, D and D_peak.
    fn disagreement(dtype: DType, several_holes: bool) -> [f64; 6] {
        let features = feature_names(several_holes).len();
        let options = options(dtype);
        let config = TrainingConfig { seed: 1, embedding: vec![64, 64, 32], ..config() };
        let networks = Networks::new(&config, features, true, &options);
        let mut rays: Vec<SolvedRay> = (0..200).map(ray).collect();
        if several_holes {
            for (i, ray) in rays.iter_mut().enumerate() {
                ray.design.fillet_ratio = 0.2 + 0.15 * (2.3 * i as f64).sin();
            }
        }
        let scales = Scales::new(&rays, 0.16, feature_names(several_holes)).unwrap();
        let samples: Vec<_> =
            rays.iter().map(|ray| scales.sample(&ray.design, &ray.samples[0])).collect();
        let predicted = predict(&networks, &Batch::new(&samples, features, &options));
        let column = |tensor: &burn::tensor::Tensor<2>, k: usize, scale: f64| -> Vec<f64> {
            let column = tensor.clone().inner().narrow(1, k, 1);
            let values: Vec<f64> = column.try_into_vec_as().unwrap();
            values.into_iter().map(|value| scale * value).collect()
        };
        let mut burn = [
            column(&predicted.energy, 0, scales.energy),
            column(&predicted.forces, 0, scales.forces[0]),
            column(&predicted.forces, 1, scales.forces[1]),
            column(&predicted.forces, 2, scales.forces[2]),
            column(&predicted.damage, 0, scales.damage),
            column(&predicted.damage, 1, scales.peak.unwrap()),
        ];
        // Burn's moment is the moment of the hinge that the networks see.
        for (i, ray) in rays.iter().enumerate() {
            let ligament = NetLigament::new(&ray.design, scales.hole);
            burn[3][i] += burn[1][i] * ligament.by_theta(ray.samples[0].theta)[0];
        }
        let parity = Parity::new(&surrogate(&networks, &scales), &rays);
        std::array::from_fn(|quantity| {
            let pairs = || burn[quantity].iter().zip(parity.points(quantity));
            let error: f64 = pairs().map(|(burn, [_, predicted])| (burn - predicted).powi(2)).sum();
            let norm: f64 = pairs().map(|(_, [_, predicted])| predicted.powi(2)).sum();
            (error / norm).sqrt()
        })
    }

    #[test]
    fn the_kernel_agrees_with_burn_in_both_precisions() {
        for (dtype, tolerance) in [(DType::F32, 1e-6), (DType::F64, 1e-14)] {
            for several_holes in [false, true] {
                let errors = disagreement(dtype, several_holes);
                let close = errors.iter().all(|&error| error < tolerance);
                assert!(close, "{dtype:?} {several_holes}: {errors:?}");
            }
        }
    }
}
