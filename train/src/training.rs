//! The training loop: optimiser steps with a cosine learning-rate schedule. Each network is taken
//! from the epoch of its minimum validation error.

use crate::config::{DAMAGE_SHARPNESS, TrainingConfig};
use crate::distillation::TrainingData;
use crate::fine_tuning::{Initial, check_pretrained, inherit};
use crate::loss::loss;
use crate::networks::{Networks, layers, options, unread};
use crate::samples::{Batch, Sample, Scales};
use crate::state::{self, Epoch, TrainingProgress, TrainingState};
use crate::validation::Parity;
use burn::grad_clipping::GradientClippingConfig;
use burn::module::ParamGroup;
use burn::optim::{AdamConfig, GradientsParams, ModuleOptimizer, MuonConfig};
use burn::tensor::{DType, TensorCreationOptions};
use dataset::{Database, Manifest, SolvedRay, Subset, samples, with_mirrored};
use hinge::TrainingDomain;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::path::Path;
use std::time::Instant;
use support::{Extremes, Fault, fault};
use surrogate::{Card, FORMAT_VERSION, Surrogate, TestErrors, UNITS, feature_names};

/// A trained surrogate with its history and test errors.
#[derive(Debug)]
pub struct Trained {
    /// The surrogate in which each network is from the epoch of its minimum validation error, or
    /// from the last epoch if that error is unknown.
    pub surrogate: Surrogate,
    /// The surrogate of the last epoch.
    pub last: Surrogate,
    /// One record per epoch.
    pub history: Vec<Epoch>,
    /// Errors on the test part, which was not used for any choice.
    pub test_errors: TestErrors,
    /// Targets and predictions on the test part.
    pub parity: Parity,
}

/// The starting point of a training.
#[derive(Clone, Copy, Debug)]
pub enum Start<'a> {
    /// Random weights.
    Fresh,
    /// The weights of another material, thickness or database: fine-tuning. They are scaled to the
    /// rows; apart from one factor for each of W, D and D_peak, the initial networks have the
    /// function of the weights.
    Weights(&'a Surrogate),
    /// A state written by [`Training::save`]; the training continues bit-exactly as if it had not
    /// been stopped.
    State {
        /// The file.
        state: &'a Path,
        /// The weights with which the training was started, if it is a fine-tuning.
        pretrained: Option<&'a Surrogate>,
    },
}

/// A training between two epochs.
pub struct Training {
    config: TrainingConfig,
    options: TensorCreationOptions,
    parts: Parts,
    scales: Scales,
    card: Card,
    samples: Vec<Sample>,
    optimiser: ModuleOptimizer,
    networks: Networks,
    best: Networks,
    history: Vec<Epoch>,
    /// Time at which [`Epoch::elapsed_s`] was `elapsed_s`.
    began: Instant,
    elapsed_s: f64,
}

/// The rays of the three parts.
struct Parts {
    training: Vec<SolvedRay>,
    validation: Vec<SolvedRay>,
    test: Vec<SolvedRay>,
}

/// Fits (14) to the database by minimising (15); section 2.4.
///
/// The same seed gives the same weights on the same machine. `progress` is called after every
/// epoch.
pub fn train(
    database: &Database,
    config: &TrainingConfig,
    progress: &mut dyn FnMut(&Epoch),
) -> Result<Trained, Fault> {
    let mut training = Training::new(database, config, Start::Fresh)?;
    while !training.is_finished() {
        progress(&training.epoch()?);
    }
    training.finish()
}

impl Training {
    /// Scales the states of the database, and initialises or loads the networks.
    pub fn new<'a>(
        data: impl Into<TrainingData<'a>>,
        config: &TrainingConfig,
        start: Start,
    ) -> Result<Self, Fault> {
        config.validate().map_err(|error| fault!("training configuration: {error}"))?;
        let began = Instant::now();
        let data: TrainingData = data.into();
        let parts = Parts::new(data.database)?;
        let manifest = data.database.manifest();
        let rays = with_mirrored(&parts.training);
        let names = feature_names(manifest.domain.holes.is_some());
        let (mut layers, mut saved) = (None, None);
        let scales = match start {
            Start::Fresh => Scales::new(&rays, manifest.hinge.fillet_ratio, names)?,
            Start::Weights(pretrained) => {
                check_pretrained(pretrained, config)?;
                let initial = Initial::new(pretrained, &rays, manifest)?;
                layers = Some(initial.layers);
                initial.scales
            }
            Start::State { state, .. } => {
                let state = saved.insert(TrainingState::read(state)?);
                Scales::from_card(&state.progress.card, &rays)?
            }
        };
        let mut card = card(manifest, &rays, &scales, config)?;
        card.distillation = data.distillation.map(|median| median.record.clone());
        match start {
            Start::Fresh => {}
            Start::Weights(pretrained) => inherit(&mut card, pretrained, &rays),
            Start::State { pretrained, .. } => {
                card.fine_tuned_from = pretrained.map(Surrogate::hash);
            }
        }
        let options = options(DType::F32);
        let networks = match &layers {
            Some(layers) => Networks::from_layers(layers, &options),
            None => Networks::new(config, scales.features(), scales.peak.is_some(), &options),
        };
        let solved = samples(&parts.training).map(|(ray, sample)| (&ray.design, sample));
        let distilled = data.distillation.into_iter();
        let distilled = distilled.flat_map(|distillation| &distillation.samples);
        let distilled = distilled.map(|(design, sample)| (design, sample));
        let mut training = Self {
            config: config.clone(),
            options,
            samples: (solved.chain(distilled))
                .map(|(design, sample)| scales.sample(design, sample))
                .collect(),
            parts,
            scales,
            card,
            optimiser: optimiser(),
            best: networks.clone(),
            networks,
            history: Vec::new(),
            began,
            elapsed_s: 0.0,
        };
        if let Some(state) = saved {
            training.resume(state)?;
        }
        training.networks = training.networks.frozen(config.frozen_layers);
        Ok(training)
    }

    /// Whether all epochs have been run.
    pub fn is_finished(&self) -> bool {
        self.history.len() >= self.config.epochs
    }

    /// The epochs run so far.
    pub fn history(&self) -> &[Epoch] {
        &self.history
    }

    /// One pass over the training states, and the states of the distillation.
    pub fn epoch(&mut self) -> Result<Epoch, Fault> {
        let epoch = self.history.len() + 1;
        let training_loss = self.descend(epoch)?;
        let learning_rate = self.learning_rate(epoch * self.steps_per_epoch());
        let diverged = || {
            Err(fault!(
                "the loss is not finite in epoch {epoch}; lower `learning_rate` = {learning_rate}"
            ))
        };
        if !training_loss.is_finite() {
            return diverged();
        }
        let surrogate = export(&self.networks, &self.card)?;
        let validation = Parity::new(&surrogate, &self.parts.validation);
        let validation_loss = validation.loss(&self.scales);
        if !validation_loss.is_finite() {
            return diverged();
        }
        let errors = validation.network_errors();
        let better = [0, 1, 2].map(|network| {
            let before = self.history.iter().map(|epoch| epoch.validation_errors[network]);
            errors[network] < before.smallest()
        });
        // The networks have no common layers, and the damage heads overfit earlier. Without a known
        // error, the network of the last epoch is kept.
        let kept = [0, 1, 2].map(|network| better[network] || errors[network].is_nan());
        if kept[0] {
            self.best.chi = self.networks.chi.clone();
        }
        if kept[1] {
            self.best.chi_d = self.networks.chi_d.clone();
        }
        if kept[2] {
            self.best.chi_p = self.networks.chi_p.clone();
        }
        let report = Epoch {
            epoch,
            epochs: self.config.epochs,
            training_loss,
            validation_loss,
            validation_errors: errors,
            learning_rate,
            best: better.contains(&true),
            elapsed_s: self.elapsed_s + self.began.elapsed().as_secs_f64(),
        };
        self.history.push(report);
        Ok(report)
    }

    /// Exports the best and the last networks and measures their errors on the test part.
    pub fn finish(mut self) -> Result<Trained, Fault> {
        self.card.training_s = self.history.last().map(|epoch| epoch.elapsed_s);
        let best = export(&self.best, &self.card)?;
        let parity = Parity::new(&best, &self.parts.test);
        let test_errors = parity.errors();
        let last = export(&self.networks, &self.card)?;
        let last_errors = Parity::new(&last, &self.parts.test).errors();
        Ok(Trained {
            surrogate: best.with_test_errors(test_errors),
            last: last.with_test_errors(last_errors),
            history: self.history,
            test_errors,
            parity,
        })
    }

    /// Atomically writes the state from which a [`Start::State`] continues.
    pub fn save(&self, path: &Path) -> Result<(), Fault> {
        let progress = TrainingProgress::new(&self.card, &self.history);
        state::write(path, &progress, &self.networks, &self.best, &self.optimiser)?;
        Ok(())
    }

    fn resume(&mut self, state: TrainingState) -> Result<(), Fault> {
        state.check(&self.card)?;
        let TrainingProgress { card, history, .. } = state.progress.clone();
        self.elapsed_s = history.last().map_or(0.0, |epoch| epoch.elapsed_s);
        (self.card, self.history) = (card, history);
        let optimiser = self.optimiser.clone();
        (self.networks, self.best, self.optimiser) = state.restore(&self.networks, optimiser)?;
        Ok(())
    }

    /// Makes the optimiser steps of one epoch, over the samples in an order given by seed and
    /// epoch. Returns the mean of (15), each batch evaluated before its step.
    fn descend(&mut self, epoch: usize) -> Result<f64, Fault> {
        let mut order: Vec<usize> = (0..self.samples.len()).collect();
        let mut rng = ChaCha8Rng::seed_from_u64(self.config.seed);
        rng.set_stream(epoch as u64);
        order.shuffle(&mut rng);
        let mut networks = self.networks.clone();
        let mut sum = 0.0;
        let first = (epoch - 1) * self.steps_per_epoch();
        for (step, batch) in order.chunks(self.config.batch_size).enumerate() {
            let samples: Vec<Sample> = batch.iter().map(|&index| self.samples[index]).collect();
            let batch = Batch::new(&samples, self.scales.features(), &self.options);
            let value = loss(&networks, &batch);
            let gradients = GradientsParams::from_grads(value.backward(), &networks);
            sum += value.try_into_scalar::<f64>().map_err(unread)? * samples.len() as f64;
            let rate = self.learning_rate(first + step);
            networks = self.optimiser.step(rate, networks, gradients);
        }
        self.networks = networks;
        Ok(sum / self.samples.len() as f64)
    }

    fn steps_per_epoch(&self) -> usize {
        self.samples.len().div_ceil(self.config.batch_size)
    }

    /// A half cosine from the initial rate at the first step to zero after the last.
    fn learning_rate(&self, step: usize) -> f64 {
        let steps = self.config.epochs * self.steps_per_epoch();
        0.5 * (1.0 + (PI * step as f64 / steps as f64).cos()) * self.config.learning_rate
    }
}

impl Parts {
    fn new(database: &Database) -> Result<Self, Fault> {
        let part = |part, name| match database.part(part) {
            rays if rays.is_empty() => Err(no_rays(name)),
            rays => Ok(rays),
        };
        Ok(Self {
            training: part(Subset::Training, "training")?,
            validation: part(Subset::Validation, "validation")?,
            test: part(Subset::Test, "test")?,
        })
    }
}

fn no_rays(part: &str) -> Fault {
    fault!("the {part} part of the split has no rays; collect more geometries")
}

/// The card before training; the test errors are added at the end.
fn card(
    manifest: &Manifest,
    training: &[SolvedRay],
    scales: &Scales,
    config: &TrainingConfig,
) -> Result<Card, Fault> {
    let states = samples(training).map(|(ray, sample)| (ray.design, sample.deformation()));
    let domain = TrainingDomain::covering(states);
    Ok(Card {
        format_version: FORMAT_VERSION,
        weights_hash: None,
        units: UNITS.into(),
        features: feature_names(manifest.domain.holes.is_some())
            .iter()
            .map(ToString::to_string)
            .collect(),
        standardisation: scales.standardisation.clone(),
        energy_scale: scales.energy,
        damage_scale: scales.damage,
        peak_scale: scales.peak,
        damage_sharpness: DAMAGE_SHARPNESS,
        domain: domain.ok_or_else(|| no_rays("training"))?,
        hinge: manifest.hinge,
        material: manifest.material.clone(),
        material_hash: the_only(&manifest.material_hashes),
        settings_hash: the_only(&manifest.settings_hashes),
        tier: manifest.tier.to_string(),
        bent_rays: manifest.bent_rays,
        dataset_hash: manifest.hash.clone(),
        fine_tuned_from: None,
        distillation: None,
        split_hash: manifest.split_hash.clone(),
        training: serde_json::to_value(config)
            .expect("a configuration of numbers and lists can always be written as JSON"),
        training_rays: Some(manifest.split.training.len()),
        training_s: None,
        test_errors: TestErrors::default(),
        spot_check: None,
        visited: None,
    })
}

/// The common hash of all rays; `None` if there are several or it is unknown.
fn the_only(hashes: &BTreeSet<String>) -> Option<String> {
    let mut hashes = hashes.iter();
    match (hashes.next(), hashes.next()) {
        (Some(hash), None) if !hash.is_empty() => Some(hash.clone()),
        _ => None,
    }
}

fn export(networks: &Networks, card: &Card) -> Result<Surrogate, Fault> {
    Surrogate::from_parts(layers(networks)?, card.clone())
        .map_err(|error| fault!("the weights cannot be exported: {error}"))
}

/// Maximum norm of the gradient of one weight matrix or bias; larger gradients are scaled down to
/// it.
const GRADIENT_NORM_MAX: f32 = 1.0;

/// Muon for the weight matrices of the embedding, Adam for all other parameters of [`Networks`].
///
/// Muon steps along the orthogonal matrix nearest to the averaged gradient, so directions in which
/// the loss is flat change as much as steep ones. In the same number of steps, the error of the
/// forces is about half of the error with Adam. The damage heads overfit with Muon and are therefore
/// trained with Adam.
fn optimiser() -> ModuleOptimizer {
    let clipping = GradientClippingConfig::Norm(GRADIENT_NORM_MAX);
    AdamConfig::new().with_epsilon(1e-8).init().with_grad_clipping(clipping.init()).with_group(
        ParamGroup::from_predicates(vec!["chi.", "weight"]),
        MuonConfig::new().build(),
        Some(clipping.init()),
    )
}
