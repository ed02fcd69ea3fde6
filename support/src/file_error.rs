//! The error of an operation on a file.

use crate::fault::Fault;
use std::io;
use std::path::{Path, PathBuf};

/// A file that cannot be read, written or parsed.
#[derive(Debug, thiserror::Error)]
#[error("{path}: {source}", path = .path.display())]
pub struct FileError {
    /// The file.
    pub path: PathBuf,
    /// Why the operation on the file failed.
    pub source: io::Error,
}

impl FileError {
    /// Maps the error of an operation on `path`, for use in `map_err`.
    pub fn at<E: Into<io::Error>>(path: &Path) -> impl FnOnce(E) -> Self {
        let path = path.to_owned();
        move |source| Self { path, source: source.into() }
    }
}

impl From<FileError> for Fault {
    fn from(FileError { path, source }: FileError) -> Self {
        fault!("{}: {source}", path.display())
    }
}
