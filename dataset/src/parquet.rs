//! Encoding and decoding of Parquet files, and their hash. A file is written in groups of rows, so that its table need
//! not be in memory.

use crate::error::DatasetError;
use crate::rows::Row;
use crate::schema;
use polars::io::parquet::write::BatchedWriter;
use polars::prelude::{ParquetReader, ParquetWriter, SerReader};
use std::io::{Cursor, Write};

/// Number of rows of a group. The rows of one group are in memory at a time.
const GROUP: usize = 1 << 16;

/// A Parquet file that is written while its rows arrive.
pub(crate) struct Table<W: Write> {
    writer: BatchedWriter<W>,
    /// The rows of the next group.
    waiting: Vec<Row>,
}

impl<W: Write> Table<W> {
    pub fn new(to: W) -> Result<Self, DatasetError> {
        Ok(Self {
            writer: ParquetWriter::new(to).batched(schema::to_frame(&[])?.schema())?,
            waiting: Vec::new(),
        })
    }

    /// Appends rows.
    pub fn add(&mut self, rows: impl IntoIterator<Item = Row>) -> Result<(), DatasetError> {
        self.waiting.extend(rows);
        while self.waiting.len() >= GROUP {
            let rest = self.waiting.split_off(GROUP);
            let group = std::mem::replace(&mut self.waiting, rest);
            self.writer.write_batch(&schema::to_frame(&group)?)?;
        }
        Ok(())
    }

    /// Writes what is left, and the end of the file.
    pub fn finish(mut self) -> Result<(), DatasetError> {
        self.writer.write_batch(&schema::to_frame(&self.waiting)?)?;
        self.writer.finish()?;
        Ok(())
    }
}

/// The bytes of the Parquet file of `rows`.
pub(crate) fn encode(rows: &[Row]) -> Result<Vec<u8>, DatasetError> {
    let mut bytes = Vec::new();
    let mut table = Table::new(&mut bytes)?;
    for group in rows.chunks(GROUP) {
        table.add(group.iter().cloned())?;
    }
    table.finish()?;
    Ok(bytes)
}

/// The rows of a Parquet file.
pub(crate) fn decode(bytes: &[u8]) -> Result<Vec<Row>, DatasetError> {
    let mut reader = ParquetReader::new(Cursor::new(bytes));
    refuse_expanding(&mut reader, bytes.len())?;
    schema::from_frame(&reader.finish()?)
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
    if values > VALUES_A_BYTE * bytes || size > EXPANSION * bytes {
        Err(DatasetError::Expanding { values, bytes })
    } else {
        Ok(())
    }
}

/// The BLAKE3 hash in hexadecimal.
pub(crate) fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// A writer that hashes what it writes.
pub(crate) struct Hashing<W> {
    to: W,
    hasher: blake3::Hasher,
}

impl<W> Hashing<W> {
    pub fn new(to: W) -> Self {
        let hasher = blake3::Hasher::new();
        Self { to, hasher }
    }

    /// [`hash`] of all that was written.
    pub fn hash(&self) -> String {
        self.hasher.finalize().to_hex().to_string()
    }
}

impl<W: Write> Write for Hashing<W> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let written = self.to.write(bytes)?;
        self.hasher.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.to.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::rows;
    use polars::prelude::{Column, DataFrame, IntoColumn, NamedFrom, Series};

    #[test]
    fn rows_that_arrive_in_parts_give_the_file_that_is_written_at_once() {
        let rows = rows(7000);
        assert!(rows.len() > GROUP);
        let mut bytes = Hashing::new(Vec::new());
        let mut table = Table::new(&mut bytes).unwrap();
        for ray in rows.chunks(10) {
            table.add(ray.to_vec()).unwrap();
        }
        table.finish().unwrap();
        assert_eq!(bytes.hash(), hash(&bytes.to));
        assert_eq!(bytes.to, encode(&rows).unwrap());
        assert_eq!(decode(&bytes.to).unwrap(), rows);

        let (mut at_once, group) = (Vec::new(), &rows[..GROUP]);
        let mut frame = schema::to_frame(group).unwrap();
        ParquetWriter::new(&mut at_once).finish(&mut frame).unwrap();
        assert_eq!(encode(group).unwrap(), at_once);
    }

    #[test]
    fn a_small_file_of_very_many_values_is_refused_before_it_is_read() {
        let zeros: Column = Series::new("W".into(), vec![0.0; 5_000_000]).into_column();
        let mut bytes = Vec::new();
        let mut frame = DataFrame::new(5_000_000, vec![zeros]).unwrap();
        ParquetWriter::new(&mut bytes).finish(&mut frame).unwrap();
        assert!(bytes.len() < 100_000, "{}", bytes.len());
        let error = decode(&bytes).unwrap_err();
        assert!(matches!(error, DatasetError::Expanding { .. }), "{error}");
        // The most regular rows that a solver could give are read.
        let regular = rows(300);
        assert_eq!(decode(&encode(&regular).unwrap()).unwrap(), regular);
    }
}
