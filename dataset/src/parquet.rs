//! Encoding and decoding of Parquet files, and their hash.

use crate::error::DatasetError;
use crate::rows::Row;
use crate::schema;
use polars::prelude::{ParquetReader, ParquetWriter, SerReader};
use std::io::Cursor;

/// The bytes of the Parquet file of `rows`.
pub(crate) fn encode(rows: &[Row]) -> Result<Vec<u8>, DatasetError> {
    let mut bytes = Vec::new();
    ParquetWriter::new(&mut bytes).finish(&mut schema::to_frame(rows)?)?;
    Ok(bytes)
}

/// The rows of a Parquet file with the given format version.
pub(crate) fn decode(bytes: &[u8], format_version: u32) -> Result<Vec<Row>, DatasetError> {
    let frame = ParquetReader::new(Cursor::new(bytes)).finish()?;
    schema::from_frame(&frame, format_version)
}

/// The BLAKE3 hash in hexadecimal.
pub(crate) fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}
