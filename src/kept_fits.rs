//! Networks kept in the folder of a study: what is trained once is not trained again.

use crate::train;
use ::train::{Backend, Start, TrainError, TrainingConfig};
use anyhow::{Context, Result};
use dataset::Database;
use std::path::Path;
use surrogate::{Card, Surrogate};

/// The network of a configuration and a database: that in the file `name` of the folder, if it was
/// trained on this very database by this very configuration, or a new one.
///
/// A training that was stopped goes on where it was.
pub fn kept_fit(
    folder: &Path,
    name: &str,
    database: &Database,
    config: &TrainingConfig,
) -> Result<Surrogate> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder {}", folder.display()))?;
    let path = folder.join(name).with_added_extension("safetensors");
    let training = serde_json::to_value(config)?;
    let manifest = database.manifest();
    let same = |card: &Card| {
        card.training == training
            && card.dataset_hash == manifest.hash
            && card.split_hash == manifest.split_hash
    };
    let kept = Surrogate::load(&path).ok();
    if let Some(kept) = kept.filter(|kept| same(kept.card())) {
        return Ok(kept);
    }
    let state = path.with_extension("state");
    let fit = |start| train::fit(database, config, Backend::default(), start, &state);
    let trained = match state.exists().then(|| fit(Start::State(&state))) {
        // The state of another training, or a damaged one, is worth nothing here.
        Some(Err(error)) if error.is::<TrainError>() => fit(Start::Fresh)?,
        Some(trained) => trained?,
        None => fit(Start::Fresh)?,
    };
    trained.surrogate.save(&path)?;
    std::fs::remove_file(&state).ok();
    Ok(trained.surrogate)
}
