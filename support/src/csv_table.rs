//! Tables whose first line names the columns; see [`text_table`](crate::text_table).

use crate::FileError;
use crate::text_table::TextTable;
use csv::StringRecord;
use serde::de::DeserializeOwned;
use std::io::{self, ErrorKind};
use std::path::Path;

/// A table whose columns have names. Its numbers have a decimal point.
#[derive(Debug)]
pub struct NamedTable {
    /// The first line, which names the columns, and its number.
    pub head: (u64, StringRecord),
    /// The cells of every row, and the number of its line.
    pub rows: Vec<(u64, StringRecord)>,
}

impl NamedTable {
    /// Reads a file; without a line it has no columns.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        let TextTable { rows, style } = TextTable::read(path)?;
        let mut rows = rows.into_iter().filter(|row| !row.is_comment());
        let head = rows.next();
        let line = head.as_ref().map_or(1, |row| row.line);
        let names = head.map_or(Vec::new(), |row| row.cells);
        let width = names.len();
        let record = |mut cells: Vec<String>| {
            // The last cells of a row may be left out.
            cells.resize(width.max(cells.len()), String::new());
            let plain = |cell: String| match style.number(&cell) {
                Some(number) if cell.parse() != Ok(number) => number.to_string(),
                _ => cell,
            };
            cells.into_iter().map(plain).collect()
        };
        Ok(Self {
            head: (line, StringRecord::from(names)),
            rows: rows.map(|row| (row.line, record(row.cells))).collect(),
        })
    }
}

/// Name in lower case and unit, which may be empty, of a column in `X (mm)`.
pub fn name_and_unit(cell: &str) -> (String, String) {
    let (name, unit) = cell.split_once(['(', '[']).unwrap_or((cell, ""));
    let unit = unit.trim_end_matches([')', ']']);
    (name.trim().to_lowercase(), unit.trim().to_owned())
}

/// The names of the columns of a file in lower case, and its rows, each with the number of its
/// line.
pub fn read<T: DeserializeOwned>(path: &Path) -> Result<(StringRecord, Vec<(u64, T)>), FileError> {
    let NamedTable { head: (_, head), rows, .. } = NamedTable::read(path)?;
    let head: StringRecord = head.iter().map(|cell| name_and_unit(cell).0).collect();
    let typed = |(line, row): (u64, StringRecord)| {
        let row = row.deserialize(Some(&head)).map_err(|error| {
            io::Error::new(ErrorKind::InvalidData, format!("line {line}: {error}"))
        })?;
        Ok((line, row))
    };
    let rows = rows.into_iter().map(typed).collect::<io::Result<_>>();
    let rows = rows.map_err(FileError::at(path))?;
    Ok((head, rows))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_numbers_are_read_as_people_write_them() {
        let file = tempfile::NamedTempFile::new().unwrap();
        for text in [
            "a,b\n1.5,2\n",
            "# a,b,c\n\nA (mm);b\n1,5;2\n# end",
            "a\tB [deg]\r\n1,5\t2\r\n",
            "\u{feff}a, b\n1.5, 2 # a remark\n",
        ] {
            std::fs::write(file.path(), text).unwrap();
            let (head, rows) = read::<(f64, f64)>(file.path()).unwrap();
            assert_eq!(head, vec!["a", "b"], "{text}");
            assert_eq!(rows[0].1, (1.5, 2.0), "{text}");
            assert_eq!(rows.len(), 1, "{text}");
        }
        let [name, unit] = ["x", "mm"].map(str::to_owned);
        assert_eq!(name_and_unit("X [mm]"), (name, unit));
    }
}
