//! Why a tensile test cannot be used.

use std::path::PathBuf;
use support::file_error::FileError;

/// A file that is not a valid tensile curve.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum TensileError {
    #[error("cannot read {0}")]
    Read(#[from] FileError),
    #[error("{path}:{line}: {what}", path = .path.display())]
    Row { path: PathBuf, line: u64, what: String },
    #[error("{path} {what}", path = .path.display())]
    File { path: PathBuf, what: String },
    #[error("{0}")]
    Specimens(String),
}
