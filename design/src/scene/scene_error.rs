//! Errors of a scene.

use crate::equilibrium::solver::EquilibriumError;
use crate::objective::design_problem::DesignError;
use crate::objective::target::TargetError;
use crate::scene::invalid_hinge::InvalidHinge;
use crate::scene::invalid_scene::InvalidScene;
use hinge::MaterialError;
use std::path::PathBuf;
use support::toml_file::ConfigError;
use surrogate::WeightsError;

/// Why a scene is invalid; every message names the file and the key.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum SceneError {
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error(transparent)]
    Material(#[from] MaterialError),
    #[error("{path}: {source}", path = .path.display())]
    Value {
        path: PathBuf,
        source: Box<InvalidScene>,
    },
    #[error("{path}: {source}", path = .path.display())]
    Hinge {
        path: PathBuf,
        source: Box<InvalidHinge>,
    },
    #[error("{path}: {source}", path = .path.display())]
    Target { path: PathBuf, source: TargetError },
    #[error(transparent)]
    Weights(#[from] WeightsError),
    #[error("{path}: {source}", path = .path.display())]
    Equilibrium {
        path: PathBuf,
        source: EquilibriumError,
    },
    #[error("{path}: objective.balance needs the gradients at the start: {source}", path = .path.display())]
    Balance { path: PathBuf, source: DesignError },
}
