//! Encoding and decoding of Parquet files, and their hash. A file is written in groups of rays, so
//! that its table need not be in memory.

use crate::schema::{self, no_table};
use fe_driver::SolvedRay;
use polars::io::parquet::write::{BatchedWriter, KeyValueMetadata};
use polars::prelude::{
    CompatLevel, ParquetReader, ParquetWriter, PolarsResult, SchemaExt, SerReader,
};
use polars_parquet::write::schema_to_metadata_key;
use std::io::{Cursor, Write};
use support::{Fault, caught_panic, fault, refuse};

/// Number of rows from which a group is complete. Its rays are in memory at a time.
const GROUP: usize = 1 << 16;

/// A Parquet file that is written while its rays arrive.
pub(crate) struct ParquetTable<W: Write> {
    writer: BatchedWriter<W>,
    /// The rays of the next group, and the number of their rows.
    waiting: Vec<SolvedRay>,
    rows: usize,
}

impl<W: Write> ParquetTable<W> {
    pub(crate) fn new(to: W) -> PolarsResult<Self> {
        let frame = schema::to_frame(&[])?;
        // Polars would declare texts as views, which Arrow's other libraries cannot filter or sort.
        let plain = schema_to_metadata_key(&frame.schema().to_arrow(CompatLevel::oldest()));
        let plain = vec![(plain.key, plain.value.unwrap_or_default())];
        let writer = ParquetWriter::new(to)
            .with_key_value_metadata(Some(KeyValueMetadata::from_static(plain)))
            .batched(frame.schema())?;
        Ok(Self { writer, waiting: Vec::new(), rows: 0 })
    }

    /// Appends a ray.
    pub(crate) fn add(&mut self, ray: SolvedRay) -> PolarsResult<()> {
        self.rows += ray.samples.len();
        self.waiting.push(ray);
        if self.rows >= GROUP {
            self.write()?;
            self.waiting.clear();
            self.rows = 0;
        }
        Ok(())
    }

    fn write(&mut self) -> PolarsResult<()> {
        self.writer.write_batch(&schema::to_frame(&self.waiting)?)
    }

    /// Writes what is left, and the end of the file.
    pub(crate) fn finish(mut self) -> PolarsResult<()> {
        self.write()?;
        self.writer.finish()?;
        Ok(())
    }
}

/// The bytes of the Parquet file of rays.
pub(crate) fn encode(rays: &[SolvedRay]) -> PolarsResult<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut table = ParquetTable::new(&mut bytes)?;
    rays.iter().try_for_each(|ray| table.add(ray.clone()))?;
    table.finish()?;
    Ok(bytes)
}

/// The rays of a Parquet file. The reader panics at some malformed files, or gives columns of
/// different lengths, which are errors like all others.
pub(crate) fn decode(bytes: &[u8]) -> Result<Vec<SolvedRay>, Fault> {
    let read = || {
        let mut reader = ParquetReader::new(Cursor::new(bytes));
        refuse_expanding(&mut reader, bytes.len())?;
        let frame = reader.finish().map_err(no_table)?;
        schema::from_frame(&frame, EXPANSION.saturating_mul(bytes.len()))
    };
    let failed = |why| fault!("the file is malformed: the Parquet reader fails with `{why}`");
    caught_panic::catch(read).map_err(failed)?
}

/// Maximum number of values in a byte of a file. Measured values do not repeat: the shipped
/// databases have 0.3.
const VALUES_A_BYTE: usize = 8;
/// Maximum size of a table over the size of its file. Measured values compress to about half.
const EXPANSION: usize = 100;

/// Rejects a file that would fill far more memory than its size, according to its metadata.
fn refuse_expanding(reader: &mut ParquetReader<Cursor<&[u8]>>, bytes: usize) -> Result<(), Fault> {
    let width = reader.schema().map_err(no_table)?.len();
    let metadata = reader.get_metadata().map_err(no_table)?;
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
    use crate::rays::tests::rays;
    use polars::prelude::{Column, DataFrame, IntoColumn, NamedFrom, Series};
    use testkit::changed;

    #[test]
    fn the_rays_of_two_groups_are_read_back() {
        let rays = rays(7000);
        let mut bytes = Hashing::new(Vec::new());
        let mut table = ParquetTable::new(&mut bytes).unwrap();
        rays.iter().for_each(|ray| table.add(ray.clone()).unwrap());
        table.finish().unwrap();
        assert_eq!(bytes.hash(), hash(&bytes.to));
        assert_eq!(bytes.to, encode(&rays).unwrap());
        let groups = ParquetReader::new(Cursor::new(&bytes.to)).get_metadata().unwrap().clone();
        let groups: Vec<_> = groups.row_groups.iter().map(|group| group.num_rows()).collect();
        assert_eq!(groups, [65_540, 4_460]);
        assert_eq!(decode(&bytes.to).unwrap(), rays);
    }

    #[test]
    fn the_rows_of_a_job_have_one_provenance_and_one_design() {
        let read = |change: fn(&mut SolvedRay)| {
            let rest = changed(rays(1), |ray| drop(ray.samples.drain(..5)));
            let first = changed(rays(1), |ray| ray.samples.truncate(5));
            let parts = [changed(first, change), rest].concat();
            decode(&encode(&parts).unwrap()).map_err(|error| error.to_string())
        };
        assert_eq!(read(|_| ()).unwrap(), rays(1));
        let differ =
            |name| Err(format!("column `{name}`, row 5: the rows of a job have different values"));
        assert_eq!(read(|ray| ray.material = "steel".into()), differ("material"));
        assert_eq!(read(|ray| ray.design.w_lig += 1e-9), differ("w_lig"));
    }

    #[test]
    fn texts_are_of_the_type_that_every_reader_of_parquet_filters() {
        let bytes = encode(&rays(3)).unwrap();
        let frame = schema::to_frame(&rays(3)).unwrap();
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
        let large = changed(rays(300), |ray| ray.material = "x".repeat(10_000));
        let bytes = encode(&large).unwrap();
        let error = decode(&bytes).unwrap_err().to_string();
        let refused = error.starts_with("the texts of the table exceed ");
        assert!(refused && error.contains("column `material`"), "{error}");
        // The most regular rays that a solver could give are read.
        let regular = rays(300);
        assert_eq!(decode(&encode(&regular).unwrap()).unwrap(), regular);
    }

    /// A generator of numbers that look random.
    fn next(state: &mut u64) -> usize {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (*state >> 33) as usize
    }

    #[test]
    fn a_malformed_file_is_an_error_and_no_panic() {
        let bytes = encode(&rays(3)).unwrap();
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
