//! The network of one round: several weights are fine-tuned on its rays, and one network learns the
//! rays and their median.

use crate::train::kept_fit;
use ::train::{Distillation, TrainingConfig, TrainingData};
use anyhow::{Context, Result};
use dataset::Database;
use hinge::{HingeDeformation, HingeDesign};
use std::{path::PathBuf, sync::atomic::AtomicBool};
use surrogate::Surrogate;

/// What the trainings of all rounds have in common.
pub(super) struct FineTuning<'a> {
    /// Weights of another material, with which fine-tuning starts.
    pub parents: Vec<Surrogate>,
    pub config: TrainingConfig,
    /// States at which the network learns the median of the fine-tuned ones.
    pub distillation: Vec<(HingeDesign, HingeDeformation)>,
    /// Folder of the trained networks.
    pub fits: PathBuf,
    /// Stops a training.
    pub stop: &'a AtomicBool,
}

impl FineTuning<'_> {
    /// The network of the first `rays` rays of the campaign, and the time of all trainings that it
    /// took (s). One parent alone is fine-tuned.
    pub(super) fn network(&self, rays: usize, database: &Database) -> Result<(Surrogate, f64)> {
        let tuned = self.parents.iter().enumerate().map(|(place, parent)| {
            let name = format!("{rays}-rays-{place}");
            kept_fit(&self.fits, &name, database, &self.config, Some(parent), self.stop)
        });
        let mut networks: Vec<Surrogate> = tuned.collect::<Result<_>>()?;
        if networks.len() > 1 {
            let data = TrainingData {
                database,
                distillation: Some(&Distillation::new(&networks, &self.distillation)),
            };
            // Any of the networks can be the start.
            let (name, first) = (format!("{rays}-rays"), Some(&networks[0]));
            networks.push(kept_fit(&self.fits, &name, data, &self.config, first, self.stop)?);
        }
        let training_s = networks.iter().filter_map(|network| network.card().training_s).sum();
        let last = networks.pop().context("fine-tuning needs weights to start from")?;
        Ok((last, training_s))
    }
}
