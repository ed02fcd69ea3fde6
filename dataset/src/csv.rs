//! CSV export of a database, and import of rows computed by other solvers.

use crate::database::Database;
use crate::error::DatasetError;
use crate::rows::Row;
use crate::schema::{D_PEAK, NUMBERS, TEXTS, columns};
use csv::StringRecord;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::Path;
use support::csv_table::NamedTable;

/// The mapping from the columns of a foreign table to the columns of a database, read from a TOML
/// file.
///
/// Each column of the database has the same name in the table unless `columns` gives another name.
/// A column that is missing in the table is taken from `constants`. `job` (the ray) and `lambda`
/// may be missing if every row is a separate ray. Of the results, W, F_a, F_s, M_theta and D are
/// required; without a model of damage, D is the constant 0.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ColumnMap {
    /// Name in the table of each column of the database.
    pub columns: BTreeMap<String, String>,
    /// Factor by which a column of numbers is multiplied: 0.017453292519943295 for angles in
    /// degrees.
    pub factors: BTreeMap<String, f64>,
    /// Value of each column that is missing in the table.
    pub constants: BTreeMap<String, Constant>,
}

/// A number or a text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(columns().map(|column| column.name))?;
        for row in &self.rows {
            let texts = TEXTS.iter().map(|column| (column.get)(row).to_owned());
            let numbers = NUMBERS.iter().map(|column| (column.get)(row).to_string());
            let d_peak = row.sample.d_peak.map_or(String::new(), |d| d.to_string());
            let ratios = row.eta().map(|ratio| ratio.to_string());
            writer.write_record(texts.chain(numbers).chain([d_peak]).chain(ratios))?;
        }
        Ok(writer.into_inner().expect("a vector takes every byte"))
    }
}

/// Reads the rows of a CSV file, to be collected into a database.
pub fn rows_from_csv(path: &Path, map: &ColumnMap) -> Result<Vec<Row>, DatasetError> {
    map.check()?;
    rows_of(NamedTable::read(path).map_err(DatasetError::Read)?, map)
        .map_err(|source| DatasetError::In { path: path.to_owned(), source: Box::new(source) })
}

fn rows_of(table: NamedTable, map: &ColumnMap) -> Result<Vec<Row>, DatasetError> {
    // Every column is read as text: numbers are parsed below, where errors can name the row.
    let table = ForeignTable {
        names: table.head.1,
        records: table.rows.into_iter().map(|(_, row)| row).collect(),
        map,
    };
    let mut rows = vec![Row::default(); table.records.len()];
    for (index, row) in rows.iter_mut().enumerate() {
        row.job = format!("row-{index:06}");
        row.sample.lambda = 1.0;
    }
    let required = |is_required: bool, column: &str| {
        let column = column.to_owned();
        is_required.then_some(DatasetError::NoColumn { column })
    };
    for text in &TEXTS {
        match (table.texts(text.name)?, required(text.name == "material", text.name)) {
            (None, Some(missing)) => return Err(missing),
            (values, _) => set_all(&mut rows, values, text.set),
        }
    }
    set_all(&mut rows, table.numbers(D_PEAK.name)?, |row, value| {
        row.sample.d_peak = Some(value).filter(|value| !value.is_nan());
    });
    for number in &NUMBERS {
        let is_required = REQUIRED.contains(&number.name);
        match (table.numbers(number.name)?, required(is_required, number.name)) {
            (None, Some(missing)) => return Err(missing),
            (values, _) => set_all(&mut rows, values, number.set),
        }
    }
    refuse_degrees(&rows)?;
    Ok(rows)
}

/// Sets a column of all rows, if it is known.
fn set_all<T>(rows: &mut [Row], values: Option<Vec<T>>, set: impl Fn(&mut Row, T)) {
    for (row, value) in rows.iter_mut().zip(values.into_iter().flatten()) {
        set(row, value);
    }
}

fn refuse_degrees(rows: &[Row]) -> Result<(), DatasetError> {
    for (index, row) in rows.iter().enumerate() {
        for (column, value) in [("alpha", row.design.alpha), ("theta", row.sample.theta)] {
            if value.abs() > PI {
                return Err(DatasetError::Degrees { column, index, value });
            }
        }
    }
    Ok(())
}

/// A table of texts, and where it has the columns of a database.
struct ForeignTable<'a> {
    names: StringRecord,
    records: Vec<StringRecord>,
    map: &'a ColumnMap,
}

impl ForeignTable<'_> {
    /// The cells of a column of a database; `None` if the table lacks it.
    fn cells(&self, name: &str) -> Result<Option<Vec<Option<String>>>, DatasetError> {
        let source = self.map.columns.get(name);
        let wanted = source.map_or(name, String::as_str);
        match (self.names.iter().position(|name| name == wanted), source) {
            (Some(at), _) => {
                let cell = |record: &StringRecord| {
                    let cell = record.get(at).filter(|cell| !cell.is_empty());
                    cell.map(str::to_owned)
                };
                Ok(Some(self.records.iter().map(cell).collect()))
            }
            (None, Some(column)) => Err(DatasetError::NoColumn { column: column.clone() }),
            (None, None) => Ok(None),
        }
    }

    /// The numbers of a column or its constant, times its factor.
    fn numbers(&self, name: &'static str) -> Result<Option<Vec<f64>>, DatasetError> {
        let mut values = match (self.cells(name)?, self.map.constants.get(name)) {
            (Some(cells), _) => parsed(name, &cells)?,
            (None, Some(Constant::Number(value))) => vec![*value; self.records.len()],
            (None, _) => return Ok(None),
        };
        let factor = self.map.factors.get(name).copied().unwrap_or(1.0);
        values.iter_mut().for_each(|value| *value *= factor);
        Ok(Some(values))
    }

    /// The texts of a column or its constant. An empty cell is an empty text; for example, most
    /// rows have no failure.
    fn texts(&self, name: &str) -> Result<Option<Vec<String>>, DatasetError> {
        let texts = self.cells(name)?.map(|cells| {
            let texts = cells.into_iter().map(Option::unwrap_or_default);
            texts.collect()
        });
        Ok(texts.or_else(|| match self.map.constants.get(name) {
            Some(Constant::Text(text)) => Some(vec![text.clone(); self.records.len()]),
            _ => None,
        }))
    }
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
        let number =
            |name: &str| name == D_PEAK.name || NUMBERS.iter().any(|column| column.name == name);
        let text = |name: &str| TEXTS.iter().any(|column| column.name == name);
        let named = self.columns.keys().find(|name| !number(name) && !text(name));
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
