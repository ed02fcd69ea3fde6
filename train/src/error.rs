//! Everything that can go wrong in a training.

use crate::config::InvalidConfig;
use crate::state::StateError;
use burn::tensor::TensorReadError;
use surrogate::InvalidWeights;

/// Why a training gave no surrogate.
#[derive(Debug, thiserror::Error)]
pub enum TrainError {
    #[error("training configuration: {0}")]
    Config(#[from] InvalidConfig),
    #[error("the {part} part of the split has no rows; collect more geometries")]
    NoRows { part: &'static str },
    #[error(
        "the feature `{feature}` is {value} in every training row, so nothing can be learned \
         about it; sample it in the campaign"
    )]
    ConstantFeature { feature: &'static str, value: f64 },
    #[error(
        "the root mean square of {target} over the training rows is {scale}: there is nothing \
         to fit"
    )]
    NoScale { target: &'static str, scale: f64 },
    #[error(
        "job {job}, lambda = {lambda}: {target} = {value:e} is {times:.0} times what nine rows in \
         ten stay under; it would drown all others, so check that job or remove its rows"
    )]
    Outlier {
        target: &'static str,
        job: String,
        lambda: f64,
        value: f64,
        times: f64,
    },
    #[error("the loss is not finite in epoch {epoch}; lower `learning_rate` = {learning_rate}")]
    Diverged { epoch: usize, learning_rate: f64 },
    #[error("the weights cannot be exported: {0}")]
    Export(#[from] InvalidWeights),
    #[error("the backend lost a tensor: {0}")]
    Backend(#[from] TensorReadError),
    #[error(
        "the weights to begin from have the layers {found:?}, the configuration asks for \
         {expected:?} (embedding and damage heads)"
    )]
    OtherSizes {
        expected: Vec<Vec<usize>>,
        found: Vec<Vec<usize>>,
    },
    #[error(
        "the weights to begin from have `damage_sharpness = {found}`; set it so in the \
         configuration, or begin afresh"
    )]
    OtherSharpness { found: f64 },
    #[error(
        "the weights to begin from do not keep the mirror symmetry; set `mirror = false` in the \
         configuration, or begin afresh"
    )]
    NotSymmetric,
    #[error(transparent)]
    State(#[from] StateError),
}
