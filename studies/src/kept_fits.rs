//! Networks stored in the folder of a study, so that each is trained once.

use ::train::{Backend, Start, TrainError, TrainingConfig};
use anyhow::{Context, Result};
use dataset::Database;
use kirigami::commands::train;
use std::path::Path;
use surrogate::{Card, Surrogate};

/// The network of a configuration and a database: the file `name` of the folder, if it was
/// trained on this database with this configuration, otherwise a new one.
///
/// A training that was stopped is continued.
pub fn kept_fit(
    folder: &Path,
    name: &str,
    database: &Database,
    config: &TrainingConfig,
) -> Result<Surrogate> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot create the folder {}", folder.display()))?;
    let path = folder.join(name).with_added_extension("safetensors");
    let training = serde_json::to_value(config)?;
    let manifest = database.manifest();
    let same = |card: &Card| {
        card.training == training
            && card.dataset_hash == manifest.hash
            && card.split_hash == manifest.split_hash
    };
    let kept = match Surrogate::load(&path) {
        Ok(kept) => Some(kept),
        Err(error) => {
            if path.exists() {
                eprintln!("{error}: trained again");
            }
            None
        }
    };
    if let Some(kept) = kept.filter(|kept| same(kept.card())) {
        return Ok(kept);
    }
    let state = path.with_extension("state");
    let fit = |start| train::fit(database, config, Backend::default(), start, &state);
    let trained = match state.exists().then(|| fit(Start::State(&state))) {
        // The state of another training, or a damaged one, is discarded.
        Some(Err(error)) if error.is::<TrainError>() => fit(Start::Fresh)?,
        Some(trained) => trained?,
        None => fit(Start::Fresh)?,
    };
    trained.surrogate.save(&path)?;
    std::fs::remove_file(&state).ok();
    Ok(trained.surrogate)
}
