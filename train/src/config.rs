//! The training configuration, read from a TOML file.

use crate::networks::widths;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use surrogate::Surrogate;

/// Sizes, loss weights and optimiser of one training.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TrainingConfig {
    /// Seed of the initial weights and of the order of the rows.
    pub seed: u64,
    /// Number of units of each layer of chi after the five features; the last layer, the embedding, is linear.
    /// At least one layer, each of 1 to 4096 units, an even number if `mirror`. In a fine-tuning, the sizes of both networks
    /// are those of the given weights.
    pub embedding: Vec<usize>,
    /// Number of units of each hidden layer of the damage heads of D and D_peak, each 1 to 4096. If `mirror`, at least
    /// one layer, each with an even number of units.
    pub damage: Vec<usize>,
    /// Whether the networks have the mirror symmetry of hinges by construction; a row then also represents
    /// its mirror image.
    pub mirror: bool,
    /// Maximum number of passes over the training rows, at least 1.
    pub epochs: usize,
    /// Number of epochs without a smaller validation error after which the training stops, at least 1; unlimited if
    /// absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub patience: Option<usize>,
    /// Number type of the training; exported weights and their evaluation are always float64.
    #[serde(default)]
    pub precision: Precision,
    /// Number of rows in one optimiser step, at least 1.
    pub batch_size: usize,
    /// The learning rate at the first step, above 0 and at most 1.
    pub learning_rate: f64,
    /// The learning rate at the end of the cosine schedule, 0 to `learning_rate`.
    pub learning_rate_end: f64,
    /// Maximum norm of the gradient of one weight matrix or bias; larger gradients are scaled down to it.
    /// Positive.
    pub gradient_norm_max: f64,
    /// gamma of (15): the weight of the energy relative to the forces, in [0, 1].
    pub energy_weight: f64,
    /// w_D of (15): the weight of the damage, at least 0.
    pub damage_weight: f64,
    /// beta of the damage heads, D = D_s softplus(beta y) / beta; from 1 to 1000.
    pub damage_sharpness: f64,
    /// Number of first layers of each network that are not trained, for fine-tuning; at most the number of hidden layers
    /// of each network.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub frozen_layers: usize,
}

#[allow(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde passes a reference"
)]
fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// Number type of a training.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// Single precision.
    #[default]
    F32,
    /// Double precision.
    F64,
}

/// A value that violates a rule of the configuration.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{key}` = {value} violates {rule}")]
pub struct InvalidConfig {
    /// The key.
    pub key: &'static str,
    /// Its value.
    pub value: String,
    /// The violated rule.
    pub rule: &'static str,
}

impl TrainingConfig {
    /// The same configuration with the network sizes of given weights.
    pub fn with_sizes_of(self, weights: &Surrogate) -> Self {
        let mut sizes = widths(&weights.layers()).into_iter();
        Self {
            embedding: sizes.next().unwrap_or_default(),
            damage: sizes.next().unwrap_or_default(),
            ..self
        }
    }

    /// Rejects impossible values; the error names the key and the rule.
    pub fn validate(&self) -> Result<(), InvalidConfig> {
        let sizes = |widths: &[usize]| widths.iter().all(|width| (1..=4096).contains(width));
        let mut units = self.embedding.iter().chain(&self.damage);
        let pairs = units.all(|units| units % 2 == 0) && !self.damage.is_empty();
        let rates = 0.0 < self.learning_rate && self.learning_rate <= 1.0;
        let rate_end =
            0.0 <= self.learning_rate_end && self.learning_rate_end <= self.learning_rate;
        let checks = [
            (
                "embedding",
                format!("{:?}", self.embedding),
                "at least one layer, each of 1 to 4096 units",
                !self.embedding.is_empty() && sizes(&self.embedding),
            ),
            (
                "damage",
                format!("{:?}", self.damage),
                "each layer of 1 to 4096 units",
                sizes(&self.damage),
            ),
            (
                "mirror",
                self.mirror.to_string(),
                "an even number of units in each layer and at least one hidden layer of the damage \
                 heads, because units form pairs of mirror images",
                !self.mirror || pairs,
            ),
            (
                "epochs",
                self.epochs.to_string(),
                "epochs >= 1",
                self.epochs >= 1,
            ),
            (
                "patience",
                format!("{:?}", self.patience),
                "patience >= 1",
                self.patience != Some(0),
            ),
            (
                "batch_size",
                self.batch_size.to_string(),
                "batch_size >= 1",
                self.batch_size >= 1,
            ),
            (
                "learning_rate",
                self.learning_rate.to_string(),
                "0 < learning_rate <= 1",
                rates,
            ),
            (
                "learning_rate_end",
                self.learning_rate_end.to_string(),
                "0 <= learning_rate_end <= learning_rate",
                rate_end,
            ),
            (
                "gradient_norm_max",
                self.gradient_norm_max.to_string(),
                "0 < gradient_norm_max",
                self.gradient_norm_max > 0.0,
            ),
            (
                "energy_weight",
                self.energy_weight.to_string(),
                "0 <= energy_weight <= 1",
                (0.0..=1.0).contains(&self.energy_weight),
            ),
            (
                "damage_weight",
                self.damage_weight.to_string(),
                "0 <= damage_weight < infinity",
                0.0 <= self.damage_weight && self.damage_weight.is_finite(),
            ),
            (
                "damage_sharpness",
                self.damage_sharpness.to_string(),
                "1 <= damage_sharpness <= 1000",
                (1.0..=1000.0).contains(&self.damage_sharpness),
            ),
            (
                "frozen_layers",
                self.frozen_layers.to_string(),
                "frozen_layers <= number of hidden layers of the embedding and of the damage heads",
                self.frozen_layers < self.embedding.len().max(1)
                    && self.frozen_layers <= self.damage.len(),
            ),
        ];
        match checks.into_iter().find(|(.., holds)| !holds) {
            Some((key, value, rule, _)) => Err(InvalidConfig { key, value, rule }),
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
        for entry in std::fs::read_dir(folder).unwrap() {
            let config: TrainingConfig = support::toml_file::read(&entry.unwrap().path()).unwrap();
            config.validate().unwrap();
            count += 1;
        }
        assert_eq!(count, 5);
    }

    #[test]
    fn errors_of_impossible_values_name_their_key() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/training");
        let demo: TrainingConfig = support::toml_file::read(&folder.join("demo.toml")).unwrap();
        type Change = fn(&mut TrainingConfig);
        let changes: [(Change, &str); 14] = [
            (|c| c.embedding.clear(), "embedding"),
            (|c| c.damage[0] = 0, "damage"),
            (|c| c.embedding[1] = 7, "mirror"),
            (|c| c.damage.clear(), "mirror"),
            (|c| c.epochs = 0, "epochs"),
            (|c| c.patience = Some(0), "patience"),
            (|c| c.batch_size = 0, "batch_size"),
            (|c| c.learning_rate = f64::NAN, "learning_rate"),
            (|c| c.learning_rate_end = 1.0, "learning_rate_end"),
            (|c| c.gradient_norm_max = 0.0, "gradient_norm_max"),
            (|c| c.energy_weight = 1.5, "energy_weight"),
            (|c| c.damage_weight = f64::INFINITY, "damage_weight"),
            (|c| c.damage_sharpness = 0.5, "damage_sharpness"),
            (|c| c.frozen_layers = 3, "frozen_layers"),
        ];
        for (change, key) in changes {
            let mut config = demo.clone();
            change(&mut config);
            assert_eq!(config.validate().unwrap_err().key, key);
        }
    }
}
