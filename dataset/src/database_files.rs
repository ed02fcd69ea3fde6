//! Reading and writing a database: `X.parquet` and its manifest `X.json`.

use crate::database::Database;
use crate::error::DatasetError;
use crate::manifest::{FORMAT_VERSION, Manifest};
use crate::parquet;
use std::path::{Path, PathBuf};
use support::regular_file;
use support::sealed_json::{self, SealError};
use support::whole_file;

impl Database {
    /// Reads `X.parquet` and its manifest `X.json`; an error if the hash of the file is not that in the manifest.
    pub fn read(path: &Path) -> Result<Self, DatasetError> {
        let parquet = read_bytes(path)?;
        if let Some(what) = other_kind(&parquet) {
            let path = path.to_owned();
            return Err(DatasetError::NoDatabase { path, what });
        }
        let manifest = read_manifest(&manifest_path(path))?;
        let found = parquet::hash(&parquet);
        if found != manifest.hash {
            return Err(DatasetError::Hash {
                path: path.to_owned(),
                expected: manifest.hash,
                found,
            });
        }
        let rows = parquet::decode(&parquet).map_err(|source| DatasetError::In {
            path: path.to_owned(),
            source: Box::new(source),
        })?;
        match manifest.disagrees(&rows) {
            None => Ok(Self {
                rows,
                parquet,
                manifest,
            }),
            Some(what) => Err(DatasetError::OtherRows {
                path: path.to_owned(),
                what,
            }),
        }
    }

    /// Writes `X.parquet` and its manifest `X.json`, each atomically.
    ///
    /// An existing file is an error unless `replace` is true.
    pub fn write(&self, path: &Path, replace: bool) -> Result<(), DatasetError> {
        refuse_existing(path, replace)?;
        whole_file::write(path, &self.parquet).map_err(unwritable(path))?;
        write_manifest(&self.manifest, &manifest_path(path))
    }
}

/// An error if `X.parquet` or its manifest exists, unless `replace` is true.
pub(crate) fn refuse_existing(path: &Path, replace: bool) -> Result<(), DatasetError> {
    let files = [path.to_owned(), manifest_path(path)];
    match files.into_iter().find(|path| !replace && path.exists()) {
        Some(path) => Err(DatasetError::Exists { path }),
        None => Ok(()),
    }
}

pub(crate) fn write_manifest(manifest: &Manifest, path: &Path) -> Result<(), DatasetError> {
    let mut json = sealed_json::to_vec(manifest).map_err(|source| DatasetError::Manifest {
        path: path.to_owned(),
        source: source.into(),
    })?;
    json.push(b'\n');
    whole_file::write(path, &json).map_err(unwritable(path))
}

pub(crate) fn manifest_path(path: &Path) -> PathBuf {
    path.with_extension("json")
}

fn read_manifest(path: &Path) -> Result<Manifest, DatasetError> {
    #[derive(serde::Deserialize)]
    struct Version {
        format_version: u64,
    }
    let malformed = |source| DatasetError::Manifest {
        path: path.to_owned(),
        source,
    };
    let bytes = read_bytes(path)?;
    let version: Version = serde_json::from_slice(&bytes)
        .map_err(SealError::from)
        .map_err(malformed)?;
    if version.format_version != u64::from(FORMAT_VERSION) {
        return Err(DatasetError::UnknownVersion {
            path: path.to_owned(),
            found: version.format_version,
            expected: FORMAT_VERSION,
        });
    }
    sealed_json::from_slice(&bytes).map_err(malformed)
}

/// What a file is whose first bytes are not those of a Parquet file.
fn other_kind(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [b'P', b'A', b'R', b'1', ..] => None,
        // Safetensors: the length of the header in eight bytes, then the header, a JSON object.
        [_, _, _, _, _, _, _, 0, b'{', ..] => Some("holds weights"),
        _ => Some("is no Parquet file"),
    }
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, DatasetError> {
    regular_file::read(path).map_err(|source| DatasetError::Read {
        path: path.to_owned(),
        source,
    })
}

/// Maps the error of writing `path`, for use in `map_err`.
pub(crate) fn unwritable(path: &Path) -> impl FnOnce(std::io::Error) -> DatasetError {
    let path = path.to_owned();
    move |source| DatasetError::Write { path, source }
}
