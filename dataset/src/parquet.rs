//! Encoding and decoding of Parquet files, and their hash. A file is written in groups of rows, so
//! that its table need not be in memory.

use crate::rows::Row;
use crate::schema::{self, DatasetError};
use polars::io::parquet::write::{BatchedWriter, KeyValueMetadata};
use polars::prelude::{CompatLevel, ParquetReader, ParquetWriter, SchemaExt, SerReader};
use polars_parquet::write::schema_to_metadata_key;
use std::io::{Cursor, Write};
use support::{caught_panic, fault, refuse};

/// Number of rows of a group. The rows of one group are in memory at a time.
const GROUP: usize = 1 << 16;

/// A Parquet file that is written while its rows arrive.
pub(crate) struct ParquetTable<W: Write> {
    writer: BatchedWriter<W>,
    /// The rows of the next group.
    waiting: Vec<Row>,
}

impl<W: Write> ParquetTable<W> {
    pub(crate) fn new(to: W) -> Result<Self, DatasetError> {
        let frame = schema::to_frame(&[])?;
        // Polars would declare texts as views, which Arrow's other libraries cannot filter or sort.
        let plain = schema_to_metadata_key(&frame.schema().to_arrow(CompatLevel::oldest()));
        let plain = vec![(plain.key, plain.value.unwrap_or_default())];
        let writer = ParquetWriter::new(to)
            .with_key_value_metadata(Some(KeyValueMetadata::from_static(plain)))
            .batched(frame.schema())?;
        Ok(Self { writer, waiting: Vec::new() })
    }

    /// Appends rows.
    pub(crate) fn add(&mut self, rows: impl IntoIterator<Item = Row>) -> Result<(), DatasetError> {
        self.waiting.extend(rows);
        while self.waiting.len() >= GROUP {
            let rest = self.waiting.split_off(GROUP);
            let group = std::mem::replace(&mut self.waiting, rest);
            self.writer.write_batch(&schema::to_frame(&group)?)?;
        }
        Ok(())
    }

    /// Writes what is left, and the end of the file.
    pub(crate) fn finish(mut self) -> Result<(), DatasetError> {
        self.writer.write_batch(&schema::to_frame(&self.waiting)?)?;
        self.writer.finish()?;
        Ok(())
    }
}

/// The bytes of the Parquet file of `rows`.
pub(crate) fn encode(rows: &[Row]) -> Result<Vec<u8>, DatasetError> {
    let mut bytes = Vec::new();
    let mut table = ParquetTable::new(&mut bytes)?;
    for group in rows.chunks(GROUP) {
        table.add(group.iter().cloned())?;
    }
    table.finish()?;
    Ok(bytes)
}

/// The rows of a Parquet file. The reader panics at some malformed files, which are errors like all
/// others.
pub(crate) fn decode(bytes: &[u8]) -> Result<Vec<Row>, DatasetError> {
    let read = || -> Result<_, DatasetError> {
        let mut reader = ParquetReader::new(Cursor::new(bytes));
        refuse_expanding(&mut reader, bytes.len())?;
        Ok(reader.finish()?)
    };
    let failed = |why| fault!("the file is malformed: the Parquet reader fails with `{why}`");
    let frame = caught_panic::catch(read).map_err(failed)??;
    schema::from_frame(&frame, EXPANSION.saturating_mul(bytes.len()))
}

/// Maximum number of values in a byte of a file. Measured values do not repeat: the shipped
/// databases have 0.3.
const VALUES_A_BYTE: usize = 8;
/// Maximum size of a table over the size of its file. Measured values compress to about half.
const EXPANSION: usize = 100;

/// Rejects a file that would fill far more memory than its size, according to its metadata.
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
    if values > VALUES_A_BYTE.saturating_mul(bytes) || size > EXPANSION.saturating_mul(bytes) {
        refuse!(
            "the file claims {values} values in {bytes} bytes, which measured data never do: it \
             is damaged, or made to fill the memory"
        );
    }
    Ok(())
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
    pub(crate) fn new(to: W) -> Self {
        let hasher = blake3::Hasher::new();
        Self { to, hasher }
    }

    /// [`hash`] of all that was written.
    pub(crate) fn hash(&self) -> String {
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
        let mut table = ParquetTable::new(&mut bytes).unwrap();
        for ray in rows.chunks(10) {
            table.add(ray.to_vec()).unwrap();
        }
        table.finish().unwrap();
        assert_eq!(bytes.hash(), hash(&bytes.to));
        assert_eq!(bytes.to, encode(&rows).unwrap());
        assert_eq!(decode(&bytes.to).unwrap(), rows);
    }

    #[test]
    fn texts_are_of_the_type_that_every_reader_of_parquet_filters() {
        let bytes = encode(&rows(3)).unwrap();
        let frame = schema::to_frame(&rows(3)).unwrap();
        let declared = |level| schema_to_metadata_key(&frame.schema().to_arrow(level)).value;
        let mut reader = ParquetReader::new(Cursor::new(&bytes));
        let metadata = reader.get_metadata().unwrap().key_value_metadata.clone().unwrap();
        let found = metadata.iter().find(|pair| pair.key == "ARROW:schema").unwrap();
        assert_eq!(found.value, declared(CompatLevel::oldest()));
        assert_ne!(found.value, declared(CompatLevel::newest()));
    }

    #[test]
    fn a_small_file_of_very_many_values_is_refused_before_it_is_read() {
        let zeros: Column = Series::new("W".into(), vec![0.0; 5_000_000]).into_column();
        let mut bytes = Vec::new();
        let mut frame = DataFrame::new(5_000_000, vec![zeros]).unwrap();
        ParquetWriter::new(&mut bytes).finish(&mut frame).unwrap();
        assert!(bytes.len() < 100_000, "{}", bytes.len());
        let error = decode(&bytes).unwrap_err().to_string();
        assert!(error.starts_with("the file claims "), "{error}");
    }

    /// A text that all rows share is stored once, and would be in memory once a row.
    #[test]
    fn a_small_file_of_very_much_text_is_refused_before_it_is_copied() {
        let mut large = rows(300);
        let long = "x".repeat(10_000);
        large.iter_mut().for_each(|row| row.material = long.clone());
        let bytes = encode(&large).unwrap();
        let error = decode(&bytes).unwrap_err().to_string();
        let refused = error.starts_with("the texts of the table exceed ");
        assert!(refused && error.contains("column `material`"), "{error}");
        // The most regular rows that a solver could give are read.
        let regular = rows(300);
        assert_eq!(decode(&encode(&regular).unwrap()).unwrap(), regular);
    }

    /// A generator of numbers that look random.
    fn next(state: &mut u64) -> usize {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (*state >> 33) as usize
    }

    #[test]
    fn a_malformed_file_is_an_error_and_no_panic() {
        let bytes = encode(&rows(3)).unwrap();
        let end = bytes.len();
        let length = u32::from_le_bytes(bytes[end - 8..end - 4].try_into().unwrap()) as usize;
        let (mut state, mut panics, mut errors) = (1, 0, 0);
        for _ in 0..3000 {
            let mut damaged = bytes.clone();
            for _ in 0..1 + next(&mut state) % 4 {
                damaged[end - 8 - length + next(&mut state) % length] = next(&mut state) as u8;
            }
            match decode(&damaged) {
                Err(error) if error.to_string().contains("reader fails") => panics += 1,
                Err(_) => errors += 1,
                Ok(_) => {}
            }
        }
        assert!(panics > 0, "the reader panics no longer: it need not be caught");
        assert!(errors > 100, "{errors}");
    }
}
