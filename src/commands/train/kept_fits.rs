//! Networks stored in a folder, so that each is trained once.

use crate::commands::train::fit;
use crate::ui::exit::Unfinished;
use ::train::{Backend, Start, TrainError, TrainingConfig};
use anyhow::{Context, Result};
use dataset::Database;
use std::path::Path;
use surrogate::{Card, Surrogate};

/// The network of a configuration, a database and its initial weights (random if there is no `parent`): the file `name` of
/// the folder, if it was trained so, otherwise a new one.
///
/// A training that was stopped is continued.
pub fn kept_fit(
    folder: &Path,
    name: &str,
    database: &Database,
    config: &TrainingConfig,
    parent: Option<&Surrogate>,
) -> Result<Surrogate> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot create the folder {}", folder.display()))?;
    let path = folder.join(name).with_added_extension("safetensors");
    let training = serde_json::to_value(config)?;
    let manifest = database.manifest();
    let from = parent.map(Surrogate::hash);
    let same = |card: &Card| {
        card.training == training
            && card.dataset_hash == manifest.hash
            && card.split_hash == manifest.split_hash
            && card.fine_tuned_from == from
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
    let fit = |start| {
        let trained = fit(database, config, Backend::default(), start, &state);
        trained.map_err(|error| match error.downcast::<Unfinished>() {
            // Here the same command continues without --resume.
            Ok(Unfinished { left, what, .. }) => Unfinished::new(left, what).into(),
            Err(error) => error,
        })
    };
    let first = parent.map_or(Start::Fresh, Start::Weights);
    let trained = match state.exists().then(|| fit(Start::State(&state))) {
        // The state of another training, or a damaged one, is discarded.
        Some(Err(error)) if error.is::<TrainError>() => fit(first)?,
        Some(Ok(trained)) if trained.surrogate.card().fine_tuned_from != from => fit(first)?,
        Some(trained) => trained?,
        None => fit(first)?,
    };
    trained.surrogate.save(&path)?;
    std::fs::remove_file(&state).ok();
    Ok(trained.surrogate)
}
