//! Errors of a training.

use crate::config::InvalidConfig;
use crate::state::StateError;
use burn::tensor::TensorReadError;
use surrogate::InvalidWeights;

/// Why a training failed.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum TrainError {
    #[error("training configuration: {0}")]
    Config(#[from] InvalidConfig),
    #[error("the {part} part of the split has no rows; collect more geometries")]
    NoRows { part: &'static str },
    #[error(
        "the feature `{feature}` is {value} in every training row, so the network cannot learn \
         its effect; vary it in the campaign"
    )]
    ConstantFeature { feature: &'static str, value: f64 },
    #[error(
        "the root mean square of {target} over the training rows is {scale}, so that it cannot be fitted; \
         check the database"
    )]
    NoScale { target: &'static str, scale: f64 },
    #[error(
        "job {job}, lambda = {lambda}: {target} = {value:e} is {times:.0} times the 90 % quantile of the \
         training rows and would dominate the loss; check that job or remove its rows"
    )]
    Outlier { target: &'static str, job: String, lambda: f64, value: f64, times: f64 },
    #[error("the loss is not finite in epoch {epoch}; lower `learning_rate` = {learning_rate}")]
    Diverged { epoch: usize, learning_rate: f64 },
    #[error("the weights cannot be exported: {0}")]
    Export(#[from] InvalidWeights),
    #[error("a tensor cannot be read from the backend: {0}")]
    Backend(#[from] TensorReadError),
    #[error(
        "the initial weights have the layers {found:?}, but the configuration has {expected:?} \
         (embedding and damage heads); change the configuration, or start with random weights"
    )]
    OtherSizes { expected: Vec<Vec<usize>>, found: Vec<Vec<usize>> },
    #[error(
        "the initial weights have `damage_sharpness = {found}`, and a training has {expected}; start with random weights",
        expected = crate::config::DAMAGE_SHARPNESS
    )]
    OtherSharpness { found: f64 },
    #[error(
        "the initial weights are for holes of several radii, but the database has holes of one radius; start with weights \
         for one radius, or with random weights"
    )]
    OneHole,
    #[error("the initial weights do not have the mirror symmetry; start with random weights")]
    NotSymmetric,
    #[error(transparent)]
    State(#[from] StateError),
}
