//! Why a tensile test cannot be used.

use std::path::PathBuf;

/// A file that is not a valid tensile curve.
#[derive(Debug, thiserror::Error)]
#[allow(
    missing_docs,
    reason = "the message of each variant is its documentation"
)]
pub enum TensileError {
    #[error("cannot read {path}: {source}", path = .path.display())]
    Read {
        path: PathBuf,
        source: std::io::Error,
    },
    #[error("{path}:{line}: {what}", path = .path.display())]
    Row {
        path: PathBuf,
        line: u64,
        what: String,
    },
    #[error("{path} {what}", path = .path.display())]
    File { path: PathBuf, what: String },
    #[error("{0}")]
    Specimens(String),
}
