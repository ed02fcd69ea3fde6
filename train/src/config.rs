//! The training configuration, read from a TOML file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use support::key_limits::{self, OutOfRange};
use surrogate::Surrogate;

/// Sizes, loss weights and optimiser of one training.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TrainingConfig {
    /// Seed of the initial weights and of the order of the rows.
    pub seed: u64,
    /// Number of units of each layer of chi after the five features; the last layer, the embedding, is linear.
    /// At least one layer, each with an even number of units if `mirror`. In a fine-tuning, the sizes of both networks are
    /// those of the given weights.
    #[schemars(inner(range(min = 1, max = 4096)))]
    pub embedding: Vec<usize>,
    /// Number of units of each hidden layer of the damage heads of D and D_peak. If `mirror`, at least one layer,
    /// each with an even number of units.
    #[schemars(inner(range(min = 1, max = 4096)))]
    pub damage: Vec<usize>,
    /// Whether the networks have the mirror symmetry of hinges by construction; a row then also represents
    /// its mirror image.
    pub mirror: bool,
    /// Maximum number of passes over the training rows.
    #[schemars(range(min = 1, max = 1_000_000))]
    pub epochs: usize,
    /// Number of epochs without a smaller validation error after which the training stops; unlimited if absent.
    #[schemars(range(min = 1, max = 1_000_000))]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub patience: Option<usize>,
    /// Number type of the training; exported weights and their evaluation are always float64.
    #[serde(default)]
    pub precision: Precision,
    /// Number of rows in one optimiser step.
    #[schemars(range(min = 1, max = 1_000_000))]
    pub batch_size: usize,
    /// The learning rate at the first step.
    #[schemars(range(min = 1e-30, max = 1.0))]
    pub learning_rate: f64,
    /// The learning rate at the end of the cosine schedule, at most `learning_rate`.
    #[schemars(range(min = 0.0))]
    pub learning_rate_end: f64,
    /// Maximum norm of the gradient of one weight matrix or bias; larger gradients are scaled down to it.
    #[schemars(range(min = 1e-9))]
    pub gradient_norm_max: f64,
    /// gamma of (15): the weight of the energy relative to the forces.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub energy_weight: f64,
    /// w_D of (15): the weight of the damage.
    #[schemars(range(min = 0.0))]
    pub damage_weight: f64,
    /// beta of the damage heads, D = D_s softplus(beta y) / beta.
    #[schemars(range(min = 1.0, max = 1000.0))]
    pub damage_sharpness: f64,
    /// Number of first layers of each network that are not trained, for fine-tuning; at most the number of hidden layers
    /// of each network.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub frozen_layers: usize,
}

/// Maximum number of layers of a network.
const MOST_LAYERS: usize = 16;

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
#[schemars(rename = "NumberType")]
pub enum Precision {
    /// Single precision.
    #[default]
    F32,
    /// Double precision.
    F64,
}

/// A value that violates a rule of the configuration.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(
    missing_docs,
    reason = "the message of each variant is its documentation"
)]
pub enum InvalidConfig {
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    #[error("{key} = {value} violates {rule}")]
    Rule {
        key: &'static str,
        value: String,
        rule: &'static str,
    },
}

impl TrainingConfig {
    /// The same configuration with the network sizes of given weights.
    pub fn with_sizes_of(self, weights: &Surrogate) -> Self {
        let mut sizes = weights.layers().widths().into_iter();
        Self {
            embedding: sizes.next().unwrap_or_default(),
            damage: sizes.next().unwrap_or_default(),
            ..self
        }
    }

    /// Rejects impossible values; the error names the key and the rule.
    pub fn validate(&self) -> Result<(), InvalidConfig> {
        key_limits::check::<Self>(self)?;
        let mut units = self.embedding.iter().chain(&self.damage);
        let pairs = units.all(|units| units % 2 == 0) && !self.damage.is_empty();
        let checks = [
            (
                "embedding",
                format!("{:?}", self.embedding),
                "1 to 16 layers",
                (1..=MOST_LAYERS).contains(&self.embedding.len()),
            ),
            (
                "damage",
                format!("{:?}", self.damage),
                "at most 16 layers",
                self.damage.len() <= MOST_LAYERS,
            ),
            (
                "mirror",
                self.mirror.to_string(),
                "an even number of units in each layer and at least one hidden layer of the damage \
                 heads, because units form pairs of mirror images",
                !self.mirror || pairs,
            ),
            (
                "learning_rate_end",
                self.learning_rate_end.to_string(),
                "learning_rate_end <= learning_rate",
                self.learning_rate_end <= self.learning_rate,
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
            Some((key, value, rule, _)) => Err(InvalidConfig::Rule { key, value, rule }),
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
        assert_eq!(count, 6);
    }

    #[test]
    fn errors_of_impossible_values_name_their_key() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/training");
        let demo: TrainingConfig = support::toml_file::read(&folder.join("demo.toml")).unwrap();
        type Change = fn(&mut TrainingConfig);
        let changes: [(Change, &str); 19] = [
            (|c| c.embedding = vec![8; 17], "embedding"),
            (|c| c.damage = vec![8; 17], "damage"),
            (|c| c.epochs = 1_000_001, "epochs"),
            (|c| c.patience = Some(1_000_001), "patience"),
            (|c| c.batch_size = 1_000_001, "batch_size"),
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
            let message = config.validate().unwrap_err().to_string();
            assert!(message.starts_with(&format!("{key} = ")), "{message}");
        }
    }
}
