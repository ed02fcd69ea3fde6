//! The training configuration, read from a TOML file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use support::{Fault, fault, key_limits};
use surrogate::Surrogate;

/// Sizes, loss weights and optimiser of one training.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TrainingConfig {
    /// Seed of the initial weights and of the order of the rows.
    pub seed: u64,
    /// Number of units of each layer of chi after the features (13): 1 to 16 layers, each with an
    /// even number of units. The last layer, the embedding, is linear. The heads of D and D_peak
    /// have two hidden layers of the size of the first. In a fine-tuning, the sizes are the sizes
    /// of the given weights.
    #[schemars(inner(range(min = 1, max = 4096)))]
    pub embedding: Vec<usize>,
    /// Number of passes over the training rows.
    #[schemars(range(min = 1, max = 1_000_000))]
    pub epochs: usize,
    /// Number of rows in one optimiser step.
    #[schemars(range(min = 1, max = 1_000_000))]
    pub batch_size: usize,
    /// The learning rate at the first step; it decreases to zero as a half cosine over all steps.
    #[schemars(range(min = 1e-30, max = 1.0))]
    pub learning_rate: f64,
    /// Number of first layers of each network that are not trained, for fine-tuning; at most the
    /// number of hidden layers of each network.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub frozen_layers: usize,
}

/// gamma of (15): the weight of the energy W; 1 - gamma is the weight of the forces.
pub(crate) const ENERGY_WEIGHT: f64 = 0.1;
/// w_D of (15): the weight of the damage.
pub(crate) const DAMAGE_WEIGHT: f64 = 0.1;
/// beta of the damage heads, D = D_s softplus(beta y) / beta: the larger, the sharper the onset at
/// yield.
pub(crate) const DAMAGE_SHARPNESS: f64 = 8.0;

/// Maximum number of layers of a network.
const MOST_LAYERS: usize = 16;

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_zero(count: &usize) -> bool {
    *count == 0
}

impl TrainingConfig {
    /// The same configuration with the network sizes of given weights.
    pub fn with_sizes_of(self, weights: &Surrogate) -> Self {
        let mut sizes = weights.layers().widths().into_iter();
        Self { embedding: sizes.next().unwrap_or_default(), ..self }
    }

    /// Number of units of the hidden layers of a damage head.
    pub(crate) fn damage(&self) -> [usize; 2] {
        [self.embedding.first().copied().unwrap_or_default(); 2]
    }

    /// Rejects impossible values; the error names the key and the rule.
    pub fn validate(&self) -> Result<(), Fault> {
        key_limits::check::<Self>(self)?;
        let checks = [
            (
                "embedding",
                format!("{:?}", self.embedding),
                "1 to 16 layers, each with an even number of units, which form pairs of mirror images",
                (1..=MOST_LAYERS).contains(&self.embedding.len())
                    && self.embedding.iter().all(|units| units % 2 == 0),
            ),
            (
                "frozen_layers",
                self.frozen_layers.to_string(),
                "frozen_layers <= number of hidden layers of the embedding and of the damage heads",
                self.frozen_layers < self.embedding.len().max(1)
                    && self.frozen_layers <= self.damage().len(),
            ),
        ];
        match checks.into_iter().find(|(.., holds)| !holds) {
            Some((key, value, rule, _)) => Err(fault!("{key} = {value} violates {rule}")),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn every_shipped_configuration_is_valid() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/training");
        let mut count = 0;
        for folder in [folder.join("plate"), folder] {
            let entries = std::fs::read_dir(folder).unwrap();
            let files = entries.map(|entry| entry.unwrap().path());
            for file in files.filter(|file| file.is_file()) {
                let config: TrainingConfig = support::toml_file::read(&file).unwrap();
                config.validate().unwrap();
                count += 1;
            }
        }
        assert_eq!(count, 7);
    }

    #[test]
    fn errors_of_impossible_values_name_their_key() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/training");
        let tiny: TrainingConfig = support::toml_file::read(&folder.join("tiny.toml")).unwrap();
        type Change = fn(&mut TrainingConfig);
        let changes: [(Change, &str); 9] = [
            (|c| c.embedding = vec![8; 17], "embedding"),
            (|c| c.epochs = 1_000_001, "epochs"),
            (|c| c.batch_size = 1_000_001, "batch_size"),
            (|c| c.embedding.clear(), "embedding"),
            (|c| c.embedding[1] = 7, "embedding"),
            (|c| c.epochs = 0, "epochs"),
            (|c| c.batch_size = 0, "batch_size"),
            (|c| c.learning_rate = f64::NAN, "learning_rate"),
            (|c| c.frozen_layers = 3, "frozen_layers"),
        ];
        for (change, key) in changes {
            let mut config = tiny.clone();
            change(&mut config);
            let message = config.validate().unwrap_err().to_string();
            assert!(message.starts_with(&format!("{key} = ")), "{message}");
        }
    }
}
