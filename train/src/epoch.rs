//! What an epoch of a training found.

use serde::{Deserialize, Deserializer, Serialize};

/// The result of one pass over the training rows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Epoch {
    /// Number of the epoch: 1, 2, ..., `epochs`.
    pub epoch: usize,
    /// Maximum number of epochs.
    pub epochs: usize,
    /// The loss (15): mean over the batches, each with the weights before its step.
    pub training_loss: f64,
    /// The loss (15) on the validation part at the end of the epoch.
    pub validation_loss: f64,
    /// Relative errors of each network on the validation part: of W and the forces (their geometric
    /// mean), of D, and of D_peak; NaN if no validation row has a known target that is not zero.
    #[serde(deserialize_with = "numbers_or_null")]
    pub validation_errors: [f64; 3],
    /// Learning rate at the end of the epoch.
    pub learning_rate: f64,
    /// Whether one of the validation errors is smaller than in all earlier epochs.
    pub best: bool,
    /// Training time so far (s).
    pub elapsed_s: f64,
}

/// JSON has no NaN.
fn numbers_or_null<'de, D: Deserializer<'de>>(values: D) -> Result<[f64; 3], D::Error> {
    let values = <[Option<f64>; 3]>::deserialize(values)?;
    Ok(values.map(|value| value.unwrap_or(f64::NAN)))
}
