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
    let mut reader = ParquetReader::new(Cursor::new(bytes));
    refuse_expanding(&mut reader, bytes.len())?;
    schema::from_frame(&reader.finish()?, format_version)
}

/// Maximum number of values in a byte of a file. Measured values do not repeat: the shipped databases have 0.3.
const VALUES_A_BYTE: usize = 8;
/// Maximum size of a table over that of its file. Measured values compress to about half.
const EXPANSION: usize = 100;

/// Rejects a file that would fill far more memory than its size, judged by its metadata.
fn refuse_expanding(
    reader: &mut ParquetReader<Cursor<&[u8]>>,
    bytes: usize,
) -> Result<(), DatasetError> {
    let width = reader.schema()?.len();
    let metadata = reader.get_metadata()?;
    let groups = metadata.row_groups.iter();
    let columns = groups.flat_map(|group| group.parquet_columns());
    let (mut values, mut size) = (metadata.num_rows.saturating_mul(width), 0_usize);
    let mut in_columns = 0_usize;
    for column in columns {
        in_columns = in_columns.saturating_add_signed(column.num_values() as isize);
        size = size.saturating_add_signed(column.uncompressed_size() as isize);
    }
    values = values.max(in_columns);
    match values > VALUES_A_BYTE * bytes || size > EXPANSION * bytes {
        true => Err(DatasetError::Expanding { values, bytes }),
        false => Ok(()),
    }
}

/// The BLAKE3 hash in hexadecimal.
pub(crate) fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::rows;
    use polars::prelude::{Column, DataFrame, IntoColumn, NamedFrom, Series};

    #[test]
    fn a_small_file_of_very_many_values_is_refused_before_it_is_read() {
        let zeros: Column = Series::new("W".into(), vec![0.0; 5_000_000]).into_column();
        let mut bytes = Vec::new();
        let mut frame = DataFrame::new(5_000_000, vec![zeros]).unwrap();
        ParquetWriter::new(&mut bytes).finish(&mut frame).unwrap();
        assert!(bytes.len() < 100_000, "{}", bytes.len());
        let error = decode(&bytes, 4).unwrap_err();
        assert!(matches!(error, DatasetError::Expanding { .. }), "{error}");
        // The most regular rows that a solver could give are read.
        let regular = rows(300);
        assert_eq!(decode(&encode(&regular).unwrap(), 4).unwrap(), regular);
    }
}
