//! Errors of a scene.

use crate::invalid_scene::InvalidScene;
use std::path::{Path, PathBuf};
use support::Fault;

/// Why a scene is invalid; every message names the file and the key.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum SceneError {
    #[error(transparent)]
    Fault(#[from] Fault),
    #[error("{path}: {source}", path = .path.display())]
    Invalid { path: PathBuf, source: Box<InvalidScene> },
}

impl SceneError {
    /// Maps what is wrong with the scene at `path`, for use in `map_err`.
    pub(super) fn at<E: Into<InvalidScene>>(path: &Path) -> impl Fn(E) -> Self {
        |source| Self::Invalid { path: path.to_owned(), source: Box::new(source.into()) }
    }
}
