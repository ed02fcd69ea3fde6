//! Trainings that continue after a stop, and networks stored in a folder, so that each is trained
//! once.

use crate::{failure::Unfinished, output_file, progress::Progress};
use ::train::{Start, Trained, Training, TrainingConfig, TrainingData};
use anyhow::{Result, bail};
use std::{
    path::Path,
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};
use support::Fault;
use surrogate::{Card, Surrogate};

/// Maximum training time that is lost if the process is killed.
const SAVE_EVERY: Duration = Duration::from_secs(30);

/// The network of a configuration, its data and its initial weights (random if there is no
/// `pretrained`): the file `name` of the folder, if it was trained so, otherwise a new one.
///
/// A training that was stopped is continued.
pub fn kept_fit<'a>(
    folder: &Path,
    name: &str,
    data: impl Into<TrainingData<'a>>,
    config: &TrainingConfig,
    pretrained: Option<&Surrogate>,
    stop: &AtomicBool,
) -> Result<Surrogate> {
    let data = data.into();
    output_file::create_folder(folder)?;
    let path = folder.join(name).with_added_extension("safetensors");
    let kept = match Surrogate::load(&path) {
        Ok(kept) => Some(kept),
        Err(error) => {
            if path.exists() {
                eprintln!("{error}: trained again");
            }
            None
        }
    };
    if let Some(kept) = kept.filter(|kept| is_of(kept.card(), data, config, pretrained)) {
        return Ok(kept);
    }
    let state = path.with_extension("state");
    let trained = continued_fit(data, config, pretrained, &state, true, stop)?;
    trained.surrogate.save(&path)?;
    std::fs::remove_file(&state).ok();
    Ok(trained.surrogate)
}

/// Whether a card belongs to the network of a configuration, its data and its initial weights.
pub(super) fn is_of(
    card: &Card,
    data: TrainingData,
    config: &TrainingConfig,
    pretrained: Option<&Surrogate>,
) -> bool {
    let manifest = data.database.manifest();
    serde_json::to_value(config).is_ok_and(|training| card.training == training)
        && card.dataset_hash == manifest.hash
        && card.split_hash == manifest.split_hash
        && card.fine_tuned_from == pretrained.map(Surrogate::hash)
        && card.distillation.as_ref() == data.record()
}

/// A training that continues from the file `state`, if it exists. The state of another training, or
/// a damaged one, is an error, or with `discard` is discarded.
pub(super) fn continued_fit(
    data: TrainingData,
    config: &TrainingConfig,
    pretrained: Option<&Surrogate>,
    state: &Path,
    discard: bool,
    stop: &AtomicBool,
) -> Result<Trained> {
    let fit = |start| fit(data, config, start, state, stop);
    let first = pretrained.map_or(Start::Fresh, Start::Weights);
    if !state.exists() {
        return fit(first);
    }
    match fit(Start::State { state, pretrained }) {
        Err(error) if discard && error.is::<Fault>() => fit(first),
        fitted => fitted,
    }
}

/// One training; its state is saved in the file `state` from time to time, when it is stopped and
/// at its end.
fn fit(
    data: TrainingData,
    config: &TrainingConfig,
    start: Start,
    state: &Path,
    stop: &AtomicBool,
) -> Result<Trained> {
    let mut training = Training::new(data, config, start)?;
    let bar = Progress::new(config.epochs, "epochs");
    let mut saved = Instant::now();
    while !training.is_finished() {
        let epoch = training.epoch()?;
        let message =
            format!("loss {:.2e}, validation {:.2e}", epoch.training_loss, epoch.validation_loss);
        bar.show(epoch.epoch, None, &message);
        let stopping = stop.load(Ordering::Relaxed);
        if stopping || saved.elapsed() > SAVE_EVERY || training.is_finished() {
            training.save(state)?;
            saved = Instant::now();
        }
        if stopping && !training.is_finished() {
            bail!(Unfinished { left: epoch.epochs - epoch.epoch, what: "epochs" });
        }
    }
    bar.finish();
    Ok(training.finish()?)
}
