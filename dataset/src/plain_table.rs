//! Tables of named columns as Parquet files, for results that are no hinge database.

use crate::error::DatasetError;
use polars::prelude::{Column, DataFrame, IntoColumn, NamedFrom, ParquetWriter, Series};

/// The values of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Numbers; a missing one is null.
    Numbers(Vec<Option<f64>>),
    /// Numbers of steps, hinges, panels.
    Counts(Vec<u32>),
    /// Truth values.
    Flags(Vec<bool>),
    /// Words.
    Texts(Vec<String>),
}

/// The bytes of a Parquet file with these columns, which must have the same length.
pub fn parquet_table(columns: &[(&str, Values)]) -> Result<Vec<u8>, DatasetError> {
    let height = columns.first().map_or(0, |(_, values)| values.len());
    let columns = columns.iter().map(|(name, values)| values.column(name));
    let mut frame = DataFrame::new(height, columns.collect())?;
    let mut bytes = Vec::new();
    ParquetWriter::new(&mut bytes).finish(&mut frame)?;
    Ok(bytes)
}

impl Values {
    fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Counts(values) => values.len(),
            Self::Flags(values) => values.len(),
            Self::Texts(values) => values.len(),
        }
    }

    fn column(&self, name: &str) -> Column {
        let series = match self {
            Self::Numbers(values) => Series::new(name.into(), values),
            Self::Counts(values) => Series::new(name.into(), values),
            Self::Flags(values) => Series::new(name.into(), values),
            Self::Texts(values) => Series::new(name.into(), values),
        };
        series.into_column()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use polars::prelude::{ParquetReader, SerReader};
    use std::io::Cursor;

    #[test]
    fn columns_are_read_back_with_their_types_and_gaps() {
        let columns = [
            ("D", Values::Numbers(vec![Some(1.0 / 3.0), None])),
            ("hinge", Values::Counts(vec![7, 4_000_000_000])),
            ("inside", Values::Flags(vec![true, false])),
            (
                "status",
                Values::Texts(vec!["converged".into(), String::new()]),
            ),
        ];
        let bytes = parquet_table(&columns).unwrap();
        let frame = ParquetReader::new(Cursor::new(bytes)).finish().unwrap();
        assert_eq!(frame.height(), 2);
        let read = |name| frame.column(name).unwrap();
        assert!(read("D").f64().unwrap().iter().eq([Some(1.0 / 3.0), None]));
        assert!(
            read("hinge")
                .u32()
                .unwrap()
                .iter()
                .eq([Some(7), Some(4_000_000_000)])
        );
        assert!(
            read("inside")
                .bool()
                .unwrap()
                .iter()
                .eq([Some(true), Some(false)])
        );
        assert!(
            read("status")
                .str()
                .unwrap()
                .iter()
                .eq([Some("converged"), Some("")])
        );
    }

    #[test]
    fn columns_of_different_lengths_are_refused() {
        let columns = [
            ("a", Values::Counts(vec![1])),
            ("b", Values::Counts(vec![1, 2])),
        ];
        assert!(parquet_table(&columns).is_err());
    }
}
