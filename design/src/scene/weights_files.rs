//! The weights that the hinge law of a scene reads.

use crate::scene::hinge_model::{HingeModel, SurrogateFile};
use crate::scene::keys::SceneConfig;
use std::path::{Path, PathBuf};

impl SceneConfig {
    /// Replaces the weights that the hinge law reads; the path is relative to the working folder. An ensemble, which
    /// belongs to the replaced weights, is dropped. A law without weights is an error.
    pub fn name_weights(&mut self, weights: &Path) -> std::io::Result<()> {
        let weights = std::path::absolute(weights)?;
        if self.hinge != HingeModel::Surrogate {
            return Err(std::io::Error::new(
                std::io::ErrorKind::InvalidInput,
                "other weights were named, but the hinge law of the scene reads none: use hinge = \"surrogate\"",
            ));
        }
        let replaced = self.surrogate.take();
        self.surrogate = Some(SurrogateFile {
            weights,
            ensemble: Vec::new(),
            springback: replaced.and_then(|learned| learned.springback),
        });
        Ok(())
    }

    /// The weights that the hinge law reads: its own first, then those of the ensemble.
    pub fn weights_files(&self) -> Vec<PathBuf> {
        let mut config = self.clone();
        config
            .weights_files_mut()
            .into_iter()
            .map(std::mem::take)
            .collect()
    }

    /// The same, to be changed.
    pub(crate) fn weights_files_mut(&mut self) -> Vec<&mut PathBuf> {
        let learned = self.surrogate.iter_mut();
        let learned = learned.filter(|_| self.hinge == HingeModel::Surrogate);
        learned
            .flat_map(|file| std::iter::once(&mut file.weights).chain(&mut file.ensemble))
            .collect()
    }

    /// The same scene without the sections of weights that its hinge law does not read.
    pub(crate) fn without_unread_weights(&self) -> Self {
        let mut config = self.clone();
        if config.hinge != HingeModel::Surrogate {
            config.surrogate = None;
        }
        config
    }
}
