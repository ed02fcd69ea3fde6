//! The error of a training.

use support::fault::Fault;

/// Why a training failed.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub struct TrainError(#[from] Fault);

impl From<burn::tensor::TensorReadError> for TrainError {
    fn from(error: burn::tensor::TensorReadError) -> Self {
        failed(format!("a tensor cannot be read from the backend: {error}"))
    }
}

/// The error with a message.
pub(crate) fn failed(what: String) -> TrainError {
    TrainError(Fault::from(what))
}
