//! CSV: the table of a database for other programs, and rows that other solvers computed.

use crate::database::{Database, DatasetError};
use crate::rows::Row;
use crate::schema::{self, KNOWN, NUMBERS, TEXTS};
use polars::prelude::{CsvReadOptions, CsvWriter, SerReader, SerWriter};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;

/// How a foreign table speaks of our columns, as a TOML file holds it.
///
/// A column of ours is looked for under its own name unless `columns` gives another; what the
/// table lacks is taken from `constants`. `job` (the ray) may be missing if every row is a ray of
/// its own, `lambda` too; of the results only W, F_a, F_s and M_theta must be there.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ColumnMap {
    /// The table's name of a column of ours.
    pub columns: BTreeMap<String, String>,
    /// What to multiply a column of numbers by: 0.017453292519943295 for angles in degrees.
    pub factors: BTreeMap<String, f64>,
    /// The value of a column that the table lacks.
    pub constants: BTreeMap<String, Constant>,
}

/// A number or a text.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Constant {
    Number(f64),
    Text(String),
}

/// Columns of numbers that a foreign table must have: what a surrogate learns from.
const REQUIRED: [&str; 12] = [
    "w_lig",
    "alpha",
    "fillet_ratio",
    "kerf",
    "r_win",
    "a",
    "s",
    "theta",
    "W",
    "F_a",
    "F_s",
    "M_theta",
];

impl Database {
    /// The table as CSV, with every digit.
    pub fn to_csv(&self) -> Result<Vec<u8>, DatasetError> {
        let mut bytes = Vec::new();
        CsvWriter::new(&mut bytes).finish(&mut schema::to_frame(&self.rows)?)?;
        Ok(bytes)
    }
}

/// The rows of a CSV file, to be collected into a database; `path` is what errors name.
pub fn rows_from_csv(path: &Path, map: &ColumnMap) -> Result<Vec<Row>, DatasetError> {
    map.check()?;
    let bytes = std::fs::read(path).map_err(|source| DatasetError::Read {
        path: path.to_owned(),
        source,
    })?;
    rows_of(&bytes, map).map_err(|source| DatasetError::In {
        path: path.to_owned(),
        source: Box::new(source),
    })
}

fn rows_of(bytes: &[u8], map: &ColumnMap) -> Result<Vec<Row>, DatasetError> {
    // Every column as text: numbers are parsed here, where errors can name the row.
    let frame = CsvReadOptions::default()
        .with_infer_schema_length(Some(0))
        .into_reader_with_file_handle(Cursor::new(bytes))
        .finish()?;
    let mut rows = vec![schema::blank(); frame.height()];
    for (index, row) in rows.iter_mut().enumerate() {
        row.job = format!("row-{index:06}");
        row.sample.lambda = 1.0;
    }
    let column = |name: &str| -> Result<Option<Vec<Option<String>>>, DatasetError> {
        let Ok(series) = frame.column(map.columns.get(name).map_or(name, String::as_str)) else {
            return match map.columns.get(name) {
                Some(source) => Err(DatasetError::NoColumn {
                    column: source.clone(),
                }),
                None => Ok(None),
            };
        };
        Ok(Some(
            series
                .str()?
                .iter()
                .map(|cell| cell.map(str::to_owned))
                .collect(),
        ))
    };
    for text in &TEXTS {
        let values = match (column(text.name)?, map.constants.get(text.name)) {
            // An empty cell is an empty text: most rows have no failure.
            (Some(cells), _) => cells
                .into_iter()
                .map(|c| Some(c.unwrap_or_default()))
                .collect(),
            (None, Some(Constant::Text(value))) => vec![Some(value.clone()); rows.len()],
            (None, _) if text.name == "material" => {
                return Err(DatasetError::NoColumn {
                    column: text.name.into(),
                });
            }
            (None, _) => continue,
        };
        schema::fill(&mut rows, text.name, values, text.set)?;
    }
    for known in &KNOWN {
        let factor = map.factors.get(known.name).copied().unwrap_or(1.0);
        if let Some(cells) = column(known.name)? {
            for (row, cell) in rows.iter_mut().zip(parsed(known.name, &cells)?) {
                (known.set)(row, Some(factor * cell).filter(|value| !value.is_nan()));
            }
        }
    }
    for number in &NUMBERS {
        let values = match (column(number.name)?, map.constants.get(number.name)) {
            (Some(cells), _) => parsed(number.name, &cells)?,
            (None, Some(Constant::Number(value))) => vec![*value; rows.len()],
            (None, _) if REQUIRED.contains(&number.name) => {
                return Err(DatasetError::NoColumn {
                    column: number.name.into(),
                });
            }
            (None, _) => continue,
        };
        let factor = map.factors.get(number.name).copied().unwrap_or(1.0);
        for (row, value) in rows.iter_mut().zip(values) {
            (number.set)(row, factor * value);
        }
    }
    Ok(rows)
}

/// An empty cell is not a number, which the gates reject.
fn parsed(column: &'static str, cells: &[Option<String>]) -> Result<Vec<f64>, DatasetError> {
    let parse = |(index, cell): (usize, &Option<String>)| match cell.as_deref() {
        None => Ok(f64::NAN),
        Some(text) => text.trim().parse().map_err(|_| DatasetError::NotANumber {
            column,
            index,
            text: text.to_owned(),
        }),
    };
    cells.iter().enumerate().map(parse).collect()
}

impl ColumnMap {
    /// Refuses columns that are none of ours, and constants of the wrong kind.
    fn check(&self) -> Result<(), DatasetError> {
        let number = |name: &str| {
            let known = KNOWN.iter().any(|column| column.name == name);
            known || NUMBERS.iter().any(|column| column.name == name)
        };
        let text = |name: &str| TEXTS.iter().any(|column| column.name == name);
        let named = self
            .columns
            .keys()
            .find(|name| !number(name) && !text(name));
        let scaled = self.factors.keys().find(|name| !number(name));
        let constant = self.constants.iter().find(|(name, value)| match value {
            Constant::Number(_) => !number(name),
            Constant::Text(_) => !text(name),
        });
        match named.or(scaled).or(constant.map(|(name, _)| name)) {
            Some(key) => Err(DatasetError::ColumnMap { key: key.clone() }),
            None => Ok(()),
        }
    }
}
