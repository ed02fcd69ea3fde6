//! The weights that the hinge law of a scene reads.

use crate::{hinge_model::SurrogateFile, keys::SceneConfig, level::Level};
use std::path::{Path, PathBuf};

impl SceneConfig {
    /// Replaces the weights that the hinge law reads; the path is relative to the working folder.
    /// Draft and ensemble, which belong to the replaced weights, are dropped. A law without weights
    /// is an error.
    pub fn name_weights(&mut self, weights: &Path) -> std::io::Result<()> {
        let weights = std::path::absolute(weights)?;
        if !self.level.is_learned() {
            return Err(std::io::Error::new(
                std::io::ErrorKind::InvalidInput,
                "other weights were named, but the hinge law of the scene reads none: use level = \"standard\"",
            ));
        }
        let replaced = self.surrogate.take();
        self.surrogate = Some(SurrogateFile {
            weights,
            draft: None,
            ensemble: Vec::new(),
            springback: replaced.and_then(|learned| learned.springback),
            solved_hinges: None,
        });
        Ok(())
    }

    /// The weights that the hinge law of the level reads: its own first, then the weights of the
    /// ensemble.
    pub fn weights_files(&self) -> Vec<PathBuf> {
        let Some(learned) = (self.surrogate.as_ref()).filter(|_| self.level.is_learned()) else {
            return Vec::new();
        };
        match self.level {
            Level::Draft => learned.draft.iter().cloned().collect(),
            _ => std::iter::once(&learned.weights).chain(&learned.ensemble).cloned().collect(),
        }
    }

    /// The same scene without the sections of weights that its hinge law does not read.
    pub(crate) fn without_unread_weights(&self) -> Self {
        let mut config = self.clone();
        if !config.level.is_learned() {
            config.surrogate = None;
        }
        config
    }
}
