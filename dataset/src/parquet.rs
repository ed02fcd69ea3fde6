//! Reading and writing: `X.parquet` and its manifest `X.json`.

use crate::database::{Database, DatasetError};
use crate::manifest::{FORMAT_VERSION, Manifest};
use crate::schema;
use polars::prelude::{DataFrame, ParquetReader, ParquetWriter, SerReader};
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// The bytes of a Parquet file.
pub(crate) fn encode(mut frame: DataFrame) -> Result<Vec<u8>, DatasetError> {
    let mut bytes = Vec::new();
    ParquetWriter::new(&mut bytes).finish(&mut frame)?;
    Ok(bytes)
}

/// BLAKE3 in hexadecimal.
pub(crate) fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// See [`Database::read`].
pub(crate) fn read(path: &Path) -> Result<Database, DatasetError> {
    let manifest = read_manifest(&manifest_path(path))?;
    let parquet = read_bytes(path)?;
    let found = hash(&parquet);
    if found != manifest.hash {
        return Err(DatasetError::Hash {
            path: path.to_owned(),
            expected: manifest.hash,
            found,
        });
    }
    let rows = ParquetReader::new(Cursor::new(&parquet))
        .finish()
        .map_err(DatasetError::from)
        .and_then(|frame| schema::from_frame(&frame, manifest.format_version))
        .map_err(|source| DatasetError::In {
            path: path.to_owned(),
            source: Box::new(source),
        })?;
    Ok(Database {
        rows,
        parquet,
        manifest,
    })
}

/// See [`Database::write`].
pub(crate) fn write(database: &Database, path: &Path, replace: bool) -> Result<(), DatasetError> {
    let manifest = manifest_path(path);
    for path in [path, &manifest] {
        if !replace && path.exists() {
            return Err(DatasetError::Exists {
                path: path.to_owned(),
            });
        }
    }
    let mut json =
        serde_json::to_vec_pretty(&database.manifest).map_err(|source| DatasetError::Manifest {
            path: manifest.clone(),
            source,
        })?;
    json.push(b'\n');
    write_bytes(path, &database.parquet)?;
    write_bytes(&manifest, &json)
}

fn manifest_path(path: &Path) -> PathBuf {
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
    let version: Version = serde_json::from_slice(&bytes).map_err(malformed)?;
    if !(2..=u64::from(FORMAT_VERSION)).contains(&version.format_version) {
        return Err(DatasetError::UnknownVersion {
            path: path.to_owned(),
            found: version.format_version,
        });
    }
    serde_json::from_slice(&bytes).map_err(malformed)
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, DatasetError> {
    std::fs::read(path).map_err(|source| DatasetError::Read {
        path: path.to_owned(),
        source,
    })
}

fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), DatasetError> {
    hinge::files::write(path, bytes).map_err(|source| DatasetError::Write {
        path: path.to_owned(),
        source,
    })
}
