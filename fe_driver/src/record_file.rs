//! JSON files of jobs and cached solves, and the hashes that name them.

use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fs::DirEntry;
use std::io;
use std::path::Path;
use support::{FileError, regular_file, sealed_json};

/// Separates damage from other errors of reading a file: `None` if the contents are damaged.
pub(crate) fn unless_damaged<T>(read: Result<T, FileError>) -> Result<Option<T>, FileError> {
    match read {
        Err(error) if error.source.kind() == io::ErrorKind::InvalidData => Ok(None),
        read => read.map(Some),
    }
}

/// The error of a file with damaged contents.
pub(crate) fn damaged(path: &Path, what: String) -> FileError {
    FileError::at(path)(io::Error::new(io::ErrorKind::InvalidData, what))
}

/// Reads a JSON file; `None` if the file does not exist.
pub(crate) fn read_json<T: DeserializeOwned>(path: &Path) -> Result<Option<T>, FileError> {
    match regular_file::read(path) {
        Ok(bytes) => sealed_json::from_slice(&bytes).map(Some).map_err(|error| {
            let hint = "the file is damaged: delete it, and the next run writes it again";
            damaged(path, format!("{error}: {hint}"))
        }),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(FileError::at(path)(error)),
    }
}

/// The entries of a folder, in no order.
pub(crate) fn entries(folder: &Path) -> Result<Vec<DirEntry>, FileError> {
    std::fs::read_dir(folder).and_then(Iterator::collect).map_err(FileError::at(folder))
}

/// Identifies the inputs that determine a result: 16 hexadecimal digits of the hash of their JSON.
pub(crate) fn short_hash(decisive: &impl Serialize) -> String {
    let text = serde_json::to_vec(decisive).expect("the inputs are numbers and text");
    blake3::hash(&text).to_hex()[..16].to_owned()
}
