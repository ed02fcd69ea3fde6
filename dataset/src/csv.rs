//! CSV export of a database, and import of rows computed by other solvers.

use crate::database::Database;
use crate::error::DatasetError;
use crate::rows::Row;
use crate::schema::{self, KNOWN, NUMBERS, TEXTS};
use polars::prelude::{CsvReadOptions, CsvWriter, SerReader, SerWriter};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::io::Cursor;
use std::path::Path;

/// The mapping from the columns of a foreign table to those of a database, read from a TOML file.
///
/// Each column of the database has the same name in the table unless `columns` gives another name. A column that is
/// missing in the table is taken from `constants`. `job` (the ray) and `lambda` may be missing if every row is a
/// separate ray. Of the results, W, F_a, F_s, M_theta and D are required; without a model of damage, D is the constant 0.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ColumnMap {
    /// Name in the table of each column of the database.
    pub columns: BTreeMap<String, String>,
    /// Factor by which a column of numbers is multiplied: 0.017453292519943295 for angles in degrees.
    pub factors: BTreeMap<String, f64>,
    /// Value of each column that is missing in the table.
    pub constants: BTreeMap<String, Constant>,
}

/// A number or a text.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Constant {
    /// The value of a column of numbers.
    Number(f64),
    /// The value of a column of texts.
    Text(String),
}

/// Columns of numbers that a foreign table must have, because a surrogate is trained on them.
const REQUIRED: [&str; 13] = [
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
    "D",
];

impl Database {
    /// The table as CSV, in full precision.
    pub fn to_csv(&self) -> Result<Vec<u8>, DatasetError> {
        let mut bytes = Vec::new();
        CsvWriter::new(&mut bytes).finish(&mut schema::to_frame(&self.rows)?)?;
        Ok(bytes)
    }
}

/// Reads the rows of a CSV file, to be collected into a database.
pub fn rows_from_csv(path: &Path, map: &ColumnMap) -> Result<Vec<Row>, DatasetError> {
    map.check()?;
    let bytes = support::regular_file::read(path).map_err(|source| DatasetError::Read {
        path: path.to_owned(),
        source,
    })?;
    rows_of(&bytes, map).map_err(|source| DatasetError::In {
        path: path.to_owned(),
        source: Box::new(source),
    })
}

fn rows_of(bytes: &[u8], map: &ColumnMap) -> Result<Vec<Row>, DatasetError> {
    // Every column is read as text: numbers are parsed below, where errors can name the row.
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
    let numbers = |name: &'static str| -> Result<Option<Vec<f64>>, DatasetError> {
        let mut values = match (column(name)?, map.constants.get(name)) {
            (Some(cells), _) => parsed(name, &cells)?,
            (None, Some(Constant::Number(value))) => vec![*value; frame.height()],
            (None, _) => return Ok(None),
        };
        let factor = map.factors.get(name).copied().unwrap_or(1.0);
        values.iter_mut().for_each(|value| *value *= factor);
        Ok(Some(values))
    };
    for text in &TEXTS {
        let values = match (column(text.name)?, map.constants.get(text.name)) {
            // An empty cell is an empty text; for example, most rows have no failure.
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
        for (row, value) in rows
            .iter_mut()
            .zip(numbers(known.name)?.unwrap_or_default())
        {
            (known.set)(row, Some(value).filter(|value| !value.is_nan()));
        }
    }
    for number in &NUMBERS {
        let values = numbers(number.name)?;
        if values.is_none() && REQUIRED.contains(&number.name) {
            return Err(DatasetError::NoColumn {
                column: number.name.into(),
            });
        }
        for (row, value) in rows.iter_mut().zip(values.unwrap_or_default()) {
            (number.set)(row, value);
        }
    }
    for (index, row) in rows.iter().enumerate() {
        for (column, value) in [("alpha", row.design.alpha), ("theta", row.sample.theta)] {
            if value.abs() > PI {
                return Err(DatasetError::Degrees {
                    column,
                    index,
                    value,
                });
            }
        }
    }
    Ok(rows)
}

/// The numbers of a column. An empty cell becomes NaN, which the gates reject.
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
    /// Rejects columns that a database does not have, and constants of the wrong type.
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
