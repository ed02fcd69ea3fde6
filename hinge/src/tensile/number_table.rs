//! A table of numbers in a text file of a testing machine: separator, decimal sign, column names and the first row
//! are recognised.
//!
//! Lines before the first row of numbers are a preamble. Of these, the last one, or the last one above a row of units,
//! names the columns. Lines that start with `#` are comments.

use crate::tensile::error::TensileError;
use crate::tensile::quantity::{Quantity, are_units, bare};
use std::collections::BTreeMap;
use std::path::Path;
use support::file_error::FileError;

/// Separators and decimal commas, in the order of preference.
const DIALECTS: [(u8, bool); 6] = [
    (b';', false),
    (b';', true),
    (b'\t', false),
    (b'\t', true),
    (b',', false),
    (b',', true),
];

/// The cells of a file; they are converted to numbers where they are used.
#[derive(Debug)]
pub(super) struct NumberTable {
    /// Name of each column with its unit, empty if the file names none.
    pub labels: Vec<String>,
    /// The rows below the names.
    pub rows: Vec<TextRow>,
    /// BLAKE3 hash of the file, 16 hexadecimal digits.
    pub hash: String,
    decimal_comma: bool,
}

/// One line of a file.
#[derive(Clone, Debug)]
pub(super) struct TextRow {
    /// Number of the line in the file, from 1.
    pub line: u64,
    cells: Vec<String>,
}

impl NumberTable {
    pub fn read(path: &Path) -> Result<Self, TensileError> {
        let bytes = support::regular_file::read(path).map_err(FileError::at(path))?;
        let hash = blake3::hash(&bytes).to_hex()[..16].to_owned();
        match Self::parse(&text_of(&bytes)) {
            Ok(table) => Ok(Self { hash, ..table }),
            Err(what) => Err(TensileError::File {
                path: path.to_owned(),
                what,
            }),
        }
    }

    fn parse(text: &str) -> Result<Self, String> {
        let numbers = |rows: &[TextRow], comma| rows.iter().map(|row| row.numbers(comma)).sum();
        let read = DIALECTS.map(|(separator, comma)| {
            let rows = split(text, separator);
            let score: usize = numbers(&rows, comma);
            (score, rows, comma)
        });
        // The first dialect of those that read most numbers: `max_by_key` would return the last.
        let best = read.iter().map(|(score, ..)| *score).max().unwrap_or(0);
        let (_, rows, decimal_comma) = read
            .into_iter()
            .find(|(score, ..)| *score == best)
            .expect("the maximum is one of the scores");
        let Some((start, width)) = first_row(&rows, decimal_comma) else {
            return Err(no_table(text));
        };
        let labels = labels(&rows[..start], width, decimal_comma)?;
        let filled =
            |row: &&TextRow| !row.is_comment() && row.cells.iter().any(|cell| !cell.is_empty());
        let rows = rows[start..].iter().filter(filled).cloned().collect();
        Ok(Self {
            labels,
            rows,
            hash: String::new(),
            decimal_comma,
        })
    }

    /// The number in a cell, or its text if it is not a finite number.
    pub fn number<'a>(&self, row: &'a TextRow, column: usize) -> Result<f64, &'a str> {
        let text = row.cells.get(column).map_or("", String::as_str);
        number(text, self.decimal_comma).ok_or(text)
    }

    /// A number to the right of the last column: a sign in another number separates the cells.
    pub fn beyond<'a>(&self, row: &'a TextRow) -> Option<&'a str> {
        let mut cells = row.cells.iter().skip(self.labels.len());
        let cell = cells.find(|cell| number(cell, self.decimal_comma).is_some())?;
        Some(cell)
    }

    /// A row in which the decimal sign of a column separates thousands: 999 is followed by 1.003, and all numbers with
    /// the sign have three digits after it.
    pub fn thousands(&self, column: usize) -> Option<&TextRow> {
        let sign = if self.decimal_comma { ',' } else { '.' };
        let (mut found, mut whole) = (None, 0.0_f64);
        for row in &self.rows {
            let text = row.cells.get(column)?;
            let number = self.number(row, column).ok()?.abs();
            match text.split_once(sign) {
                None => whole = number,
                Some((_, digits)) if digits.len() != 3 || number < 1.0 => return None,
                // Closer to 1000 times the number than to the number.
                Some(_) if whole.powi(2) > 1e3 * number.powi(2) => found = found.or(Some(row)),
                Some(_) => whole = 0.0,
            }
        }
        found
    }
}

impl TextRow {
    /// Count of the numbers, 0 if there is only one: a name with its value.
    fn numbers(&self, decimal_comma: bool) -> usize {
        let numbers = self
            .cells
            .iter()
            .filter_map(|cell| number(cell, decimal_comma));
        match numbers.count() {
            1 => 0,
            several => several,
        }
    }

    fn is_comment(&self) -> bool {
        self.cells[0].starts_with('#')
    }
}

/// A finite number with a decimal point or a decimal comma.
fn number(text: &str, decimal_comma: bool) -> Option<f64> {
    let number: f64 = if !decimal_comma {
        text.parse().ok()?
    } else if text.contains('.') {
        return None;
    } else {
        text.replace(',', ".").parse().ok()?
    };
    number.is_finite().then_some(number)
}

/// The text of a file in UTF-8, in UTF-16 with a byte order mark, or in Latin-1.
fn text_of(bytes: &[u8]) -> String {
    let utf16 = |unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = (bytes[2..].chunks_exact(2))
            .map(|pair| unit([pair[0], pair[1]]))
            .collect();
        String::from_utf16_lossy(&units)
    };
    match bytes {
        [0xFF, 0xFE, ..] => utf16(u16::from_le_bytes),
        [0xFE, 0xFF, ..] => utf16(u16::from_be_bytes),
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => text.trim_start_matches('\u{feff}').to_owned(),
            Err(_) => bytes.iter().copied().map(char::from).collect(),
        },
    }
}

/// The cells of every line that is not empty.
fn split(text: &str, separator: u8) -> Vec<TextRow> {
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(separator)
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let records = reader.records().map_while(Result::ok);
    records
        .map(|record| TextRow {
            line: record.position().map_or(0, csv::Position::line),
            cells: record.iter().map(str::to_owned).collect(),
        })
        .collect()
}

/// Index and number of cells of the first row of numbers. It has as many cells and numbers as most rows, so that a
/// preamble with two numbers in a line is not taken for the table.
fn first_row(rows: &[TextRow], decimal_comma: bool) -> Option<(usize, usize)> {
    let shape = |row: &TextRow| {
        if row.is_comment() {
            (0, 0)
        } else {
            (row.cells.len(), row.numbers(decimal_comma))
        }
    };
    let mut counts: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for shape in rows.iter().map(shape).filter(|(_, numbers)| *numbers > 0) {
        *counts.entry(shape).or_default() += 1;
    }
    let (usual, _) = counts.into_iter().max_by_key(|(_, count)| *count)?;
    let start = rows.iter().position(|row| shape(row) == usual)?;
    Some((start, usual.0))
}

/// Name and unit of each column from the lines above the first row of numbers.
fn labels(above: &[TextRow], width: usize, decimal_comma: bool) -> Result<Vec<String>, String> {
    let words = |row: &TextRow| -> Vec<String> {
        let cells = row.cells.iter();
        cells
            .map(|cell| cell.trim_start_matches('#').trim().to_owned())
            .collect()
    };
    let mut lines = above.iter().rev().map(words).peekable();
    let units = lines.next_if(|cells| are_units(cells)).unwrap_or_default();
    let mut names = lines.next().unwrap_or_default();
    let known = |names: &[String]| {
        names
            .iter()
            .all(|name| Quantity::from_label(name).is_some())
    };
    if width == 2 * names.len() && known(&names) {
        return Err(format!(
            "names {} columns, but the rows have {width} cells: if the comma is the decimal sign, save the \
             file with semicolons between the columns",
            names.len()
        ));
    }
    let named = names.len() == width
        && names
            .iter()
            .all(|name| number(name, decimal_comma).is_none());
    if !named {
        names = vec![String::new(); width];
    }
    if named || units.len() == width {
        let units = units.iter().map(|unit| bare(unit));
        for (name, unit) in names
            .iter_mut()
            .zip(units)
            .filter(|(_, unit)| !unit.is_empty())
        {
            *name = format!("{name} ({unit})").trim().to_owned();
        }
    }
    Ok(names)
}

/// Why a text contains no table.
fn no_table(text: &str) -> String {
    let mut lines = text.lines().map(str::trim);
    if lines.any(|line| number(line, line.contains(',')).is_some()) {
        "has one column of numbers: a tensile curve needs two, force or stress and extension or strain, separated by \
         commas, semicolons or tabs"
            .into()
    } else {
        "has no rows of numbers: save the curve of one specimen as text, in columns separated by commas, semicolons or \
         tabs"
            .into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Labels, lines and numbers of a text.
    fn parsed(text: &str) -> (Vec<String>, Vec<u64>, Vec<Vec<f64>>) {
        let table = NumberTable::parse(text).unwrap();
        let numbers = |row: &TextRow| {
            (0..row.cells.len())
                .map(|column| table.number(row, column).unwrap())
                .collect()
        };
        let lines = table.rows.iter().map(|row| row.line).collect();
        let values = table.rows.iter().map(numbers).collect();
        (table.labels, lines, values)
    }

    #[test]
    fn separators_and_decimal_signs_are_recognised() {
        for text in [
            "strain,stress\n0,0\n0.5,1.25\n",
            "strain;stress\n0;0\n0.5;1.25\n",
            "strain\tstress\n0\t0\n0.5\t1.25\n",
            "strain;stress\n0;0\n0,5;1,25\n",
            "strain\tstress\r\n0\t0\r\n0,5\t1,25\r\n",
            "\"strain\",\"stress\"\n\"0\",\"0\"\n\"0,5\",\"1,25\"\n",
            "# strain, stress\n0, 0\n\n0.5, 1.25\n",
        ] {
            let (labels, _, rows) = parsed(text);
            assert_eq!(labels, ["strain", "stress"], "{text}");
            assert_eq!(rows, [[0.0, 0.0], [0.5, 1.25]], "{text}");
        }
    }

    #[test]
    fn a_preamble_is_skipped_and_a_row_of_units_is_joined_to_the_names() {
        let text = "Specimen;3\nWidth;10,0;mm\nDimensions;10,0;0,5\n\nTime;Load;Extension\n(s);(kN);[mm]\n\
                    0,0;0,0;0,0\n0,1;0,2;0,3\n";
        let (labels, lines, rows) = parsed(text);
        assert_eq!(labels, ["Time (s)", "Load (kN)", "Extension (mm)"]);
        assert_eq!(lines, [7, 8]);
        assert_eq!(rows[1], [0.1, 0.2, 0.3]);
    }

    #[test]
    fn encodings_of_other_systems_are_read() {
        let text = "Dehnung (%);Spannung (N/mm²)\n0;0\n1;2\n";
        let latin: Vec<u8> = text.chars().map(|c| c as u8).collect();
        let units = text.encode_utf16();
        let wide: Vec<u8> = [0xFF, 0xFE]
            .into_iter()
            .chain(units.flat_map(u16::to_le_bytes))
            .collect();
        for bytes in [&latin, &wide, &format!("\u{feff}{text}").into_bytes()] {
            assert_eq!(text_of(bytes), text);
        }
    }

    #[test]
    fn a_file_without_a_table_says_what_it_lacks() {
        for (text, expected) in [
            ("", "no rows of numbers"),
            ("stress,strain\n", "no rows of numbers"),
            ("stress\n1\n2\n3\n", "one column"),
            ("stress\n1,5\n2,5\n", "decimal sign"),
            ("strain,stress\n0,1,2,5\n0,2,3,5\n", "decimal sign"),
        ] {
            let message = NumberTable::parse(text).unwrap_err();
            assert!(message.contains(expected), "{text}: {message}");
        }
    }
}
