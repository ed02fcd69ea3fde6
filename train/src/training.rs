//! The training loop: Adam with a cosine schedule, the best-validation checkpoint kept in memory.

use crate::backend::Backend;
use crate::config::{InvalidConfig, TrainingConfig};
use crate::export::layers;
use crate::loss::loss;
use crate::networks::Networks;
use crate::samples::{Batch, Sample, Scales};
use crate::validation::Parity;
use burn::grad_clipping::GradientClippingConfig;
use burn::optim::{AdamConfig, GradientsParams, ModuleOptimizer};
use burn::tensor::{TensorCreationOptions, TensorReadError};
use dataset::{Database, Manifest, Part, Row, with_mirrored};
use hinge::TrainingDomain;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;
use std::time::Instant;
use surrogate::{
    Card, FEATURE_NAMES, FORMAT_VERSION, InvalidWeights, Surrogate, TestErrors, UNITS,
};

/// Why a training gave no surrogate.
#[derive(Debug, thiserror::Error)]
pub enum TrainError {
    #[error("training configuration: {0}")]
    Config(#[from] InvalidConfig),
    #[error("the {part} part of the split has no rows; collect more geometries")]
    NoRows { part: &'static str },
    #[error(
        "the feature `{feature}` is {value} in every training row, so nothing can be learned \
         about it; sample it in the campaign"
    )]
    ConstantFeature { feature: &'static str, value: f64 },
    #[error(
        "the root mean square of {target} over the training rows is {scale}: there is nothing \
         to fit"
    )]
    NoScale { target: &'static str, scale: f64 },
    #[error("the loss is not finite in epoch {epoch}; lower `learning_rate` = {learning_rate}")]
    Diverged { epoch: usize, learning_rate: f64 },
    #[error("the weights cannot be exported: {0}")]
    Export(#[from] InvalidWeights),
    #[error("the backend lost a tensor: {0}")]
    Backend(#[from] TensorReadError),
}

/// What one pass over the training rows did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Epoch {
    /// 1, 2, ..., `epochs`
    pub epoch: usize,
    /// Of how many.
    pub epochs: usize,
    /// (15), mean over the batches as they were met.
    pub training_loss: f64,
    /// (15) on the validation part at the end of the epoch.
    pub validation_loss: f64,
    /// At the end of the epoch.
    pub learning_rate: f64,
    /// Whether no epoch before had a smaller validation loss.
    pub best: bool,
    /// Wall time since training began (s).
    pub elapsed_s: f64,
}

/// A trained surrogate and what is known about it.
#[derive(Clone, Debug)]
pub struct Trained {
    /// Of the epoch with the least validation loss.
    pub surrogate: Surrogate,
    pub history: Vec<Epoch>,
    /// On the test part, which nothing was chosen by.
    pub test_errors: TestErrors,
    /// Targets and predictions on the test part.
    pub parity: Parity,
}

/// The rows of the three parts, mirrored if asked for.
struct Parts {
    training: Vec<Row>,
    validation: Vec<Row>,
    test: Vec<Row>,
}

/// Fits (14) to the database by minimising (15); section 2.4.
///
/// The same seed gives the same weights on the same machine. `progress` sees every epoch.
pub fn train(
    database: &Database,
    config: &TrainingConfig,
    backend: Backend,
    progress: &mut dyn FnMut(&Epoch),
) -> Result<Trained, TrainError> {
    config.validate()?;
    let began = Instant::now();
    let parts = Parts::of(database, config.mirror)?;
    let scales = Scales::of(&parts.training)?;
    let card = card(database.manifest(), &parts.training, &scales, config)?;
    let mut samples: Vec<Sample> = parts
        .training
        .iter()
        .map(|row| scales.sample(row))
        .collect();

    let mut descent = Descent::new(config, samples.len(), backend);
    let mut networks = descent.initial_networks();
    let mut history: Vec<Epoch> = Vec::new();
    let mut least = f64::INFINITY;
    let mut best = None;
    for epoch in 1..=config.epochs {
        let training_loss;
        (networks, training_loss) = descent.epoch(networks, &mut samples)?;
        let learning_rate = descent.learning_rate();
        let diverged = TrainError::Diverged {
            epoch,
            learning_rate,
        };
        if !training_loss.is_finite() {
            return Err(diverged);
        }
        let surrogate = export(&networks, &card)?;
        let validation_loss = Parity::of(&surrogate, &parts.validation).loss(&scales, config);
        if !validation_loss.is_finite() {
            return Err(diverged);
        }
        let report = Epoch {
            epoch,
            epochs: config.epochs,
            training_loss,
            validation_loss,
            learning_rate,
            best: validation_loss < least,
            elapsed_s: began.elapsed().as_secs_f64(),
        };
        if report.best {
            least = validation_loss;
            best = Some(surrogate);
        }
        progress(&report);
        history.push(report);
    }
    let best = best.expect("the first epoch has a finite validation loss, which is the least");
    let parity = Parity::of(&best, &parts.test);
    let test_errors = parity.errors();
    Ok(Trained {
        surrogate: best.with_test_errors(test_errors),
        history,
        test_errors,
        parity,
    })
}

impl Parts {
    fn of(database: &Database, mirror: bool) -> Result<Self, TrainError> {
        let part = |part, name| {
            let rows = database.part(part);
            match rows.is_empty() {
                true => Err(TrainError::NoRows { part: name }),
                false if mirror => Ok(with_mirrored(&rows)),
                false => Ok(rows),
            }
        };
        Ok(Self {
            training: part(Part::Training, "training")?,
            validation: part(Part::Validation, "validation")?,
            test: part(Part::Test, "test")?,
        })
    }
}

/// Adam along its schedule.
struct Descent<'a> {
    config: &'a TrainingConfig,
    options: TensorCreationOptions,
    optimiser: ModuleOptimizer,
    rng: ChaCha8Rng,
    step: usize,
    steps: usize,
}

impl<'a> Descent<'a> {
    fn new(config: &'a TrainingConfig, rows: usize, backend: Backend) -> Self {
        let clipping = GradientClippingConfig::Norm(config.gradient_norm_max as f32);
        Self {
            config,
            options: TensorCreationOptions::new(backend.device()),
            optimiser: AdamConfig::new()
                .with_epsilon(1e-8)
                .with_grad_clipping(Some(clipping))
                .init(),
            rng: ChaCha8Rng::seed_from_u64(config.seed),
            step: 0,
            steps: config.epochs * rows.div_ceil(config.batch_size),
        }
    }

    fn initial_networks(&self) -> Networks {
        let TrainingConfig {
            embedding,
            damage,
            seed,
            ..
        } = self.config;
        Networks::new(embedding, damage, *seed, &self.options)
    }

    /// One pass over the samples in a new order; the mean of (15) as it was met.
    fn epoch(
        &mut self,
        mut networks: Networks,
        samples: &mut [Sample],
    ) -> Result<(Networks, f64), TrainError> {
        samples.shuffle(&mut self.rng);
        let mut sum = 0.0;
        for batch in samples.chunks(self.config.batch_size) {
            let value = loss(&networks, &Batch::new(batch, &self.options), self.config);
            let gradients = GradientsParams::from_grads(value.backward(), &networks);
            sum += value.try_into_scalar::<f64>()? * batch.len() as f64;
            networks = self
                .optimiser
                .step(self.learning_rate(), networks, gradients);
            self.step += 1;
        }
        Ok((networks, sum / samples.len() as f64))
    }

    /// Half a cosine from `learning_rate` at the first step to `learning_rate_end` after the last.
    fn learning_rate(&self) -> f64 {
        let share = 0.5 * (1.0 + (PI * self.step as f64 / self.steps as f64).cos());
        let end = self.config.learning_rate_end;
        end + share * (self.config.learning_rate - end)
    }
}

/// What is known before training; the test errors follow.
fn card(
    manifest: &Manifest,
    training: &[Row],
    scales: &Scales,
    config: &TrainingConfig,
) -> Result<Card, TrainError> {
    let states: Vec<_> = training
        .iter()
        .map(|row| (row.design, row.sample.deformation()))
        .collect();
    let domain = TrainingDomain::covering(states.iter().map(|(g, eps)| (g, eps)));
    Ok(Card {
        format_version: FORMAT_VERSION,
        units: UNITS.into(),
        features: FEATURE_NAMES.map(Into::into).to_vec(),
        standardisation: scales.standardisation,
        energy_scale: scales.energy,
        damage_scale: scales.damage,
        domain: domain.ok_or(TrainError::NoRows { part: "training" })?,
        hinge: manifest.hinge,
        material: manifest.material.clone(),
        tier: manifest.tier.clone(),
        dataset_hash: manifest.hash.clone(),
        split_hash: manifest.split_hash.clone(),
        training: serde_json::to_value(config)
            .expect("a configuration of numbers and lists is always JSON"),
        test_errors: TestErrors::default(),
    })
}

fn export(networks: &Networks, card: &Card) -> Result<Surrogate, TrainError> {
    let (chi, chi_d) = (layers(&networks.chi)?, layers(&networks.chi_d)?);
    Ok(Surrogate::from_parts(chi, chi_d, card.clone())?)
}
