//! The record of one epoch.

use serde::{Deserialize, Serialize};

/// What one pass over the training rows did.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Epoch {
    /// 1, 2, ..., `epochs`
    pub epoch: usize,
    /// Of how many.
    pub epochs: usize,
    /// (15), mean over the batches as they were met.
    pub training_loss: f64,
    /// (15) on the validation part at the end of the epoch.
    pub validation_loss: f64,
    /// Relative errors of each network there: of W and the forces (their geometric mean), of D,
    /// and of D_peak (zero if it is not predicted).
    pub validation_errors: [f64; 3],
    /// At the end of the epoch.
    pub learning_rate: f64,
    /// Whether one of them was less than in every epoch before.
    pub best: bool,
    /// Time that the training took so far (s).
    pub elapsed_s: f64,
}
