//! The tables of a file of a testing machine, one a specimen: side by side, with the names of the
//! columns repeated in one line, or below each other, with the line of names repeated.
//!
//! Lines before the first row of numbers are a preamble. Of these, the last one, or the last one
//! above a row of units, names the columns. Lines that start with `#` are comments.

use crate::in_file;
use crate::name::Name;
use crate::quantity::{Quantity::Extension, are_units, bare};
use serde::Serialize;
use std::path::Path;
use support::text_table::{NumberStyle, TextRow, TextTable};
use support::{Fault, regular_file, text_file, unread};

/// The cells of one specimen; they are converted to numbers where they are used.
#[derive(Clone, Debug)]
pub(super) struct NumberTable {
    /// Name of each column of the file with its unit, empty if the file names none or the column is
    /// of another specimen.
    pub labels: Vec<String>,
    /// The lines above the names.
    pub preamble: Vec<TextRow>,
    /// The rows below the names.
    pub rows: Vec<TextRow>,
    /// How numbers are written.
    pub style: NumberStyle,
}

impl NumberTable {
    /// The tables of a file, and its BLAKE3 hash, 16 hexadecimal digits.
    pub(crate) fn read_all(path: &Path) -> Result<(Vec<Self>, String), Fault> {
        let bytes = regular_file::read(path).map_err(unread(path))?;
        let hash = blake3::hash(&bytes).to_hex()[..16].to_owned();
        let text = text_file::decoded(&bytes).map_err(unread(path))?;
        Ok((Self::parse(&text).map_err(in_file(path))?, hash))
    }

    fn parse(text: &str) -> Result<Vec<Self>, String> {
        let TextTable { rows, style } = TextTable::parse(text);
        let Some((start, width)) = first_row(&rows, style) else {
            return Err(no_table(text));
        };
        let (above, below) = rows.split_at(start);
        let labels = labels(above, width, style)?;
        let names = above.len() - usize::from(above.last().is_some_and(has_units));
        let head = above[..names].last();
        let parts = below.chunk_by(|_, row| head.is_none_or(|head| row.cells != head.cells));
        let mut preamble = above.to_vec();
        let mut tables = Vec::new();
        for part in parts {
            let begin = usize::from(head.is_some_and(|head| part[0].cells == head.cells));
            let last = part.iter().rposition(|row| row.numbers(style) > 0);
            // The title of the next specimen stands above its names.
            let end = match last {
                _ if part.len() == below.len() => part.len(),
                Some(last) => last + 1,
                None => continue,
            };
            let preamble = std::mem::replace(&mut preamble, part[end..].to_vec());
            let rows = part[begin..end].iter().skip_while(|row| has_units(row));
            let filled =
                |row: &&TextRow| !row.is_comment() && row.cells.iter().any(|cell| !cell.is_empty());
            tables.push(Self {
                labels: labels.clone(),
                preamble,
                rows: rows.filter(filled).cloned().collect(),
                style,
            });
        }
        Ok(tables)
    }

    /// The tables of specimens that stand side by side, with the same names in the same order;
    /// `None` if there is one.
    pub(crate) fn side_by_side(&self) -> Option<Vec<Self>> {
        // Specimens may be numbered.
        let letters = |c: char| !c.is_ascii_digit();
        let name = |label: &String| label.to_lowercase().chars().filter(|c| letters(*c)).collect();
        let names: Vec<String> = self.labels.iter().map(name).collect();
        let width = (2..names.len()).find(|&width| {
            let mut parts = names.chunks(width);
            let named = names[..width].iter().any(|name| !name.is_empty());
            named && names.len().is_multiple_of(width) && parts.all(|part| part == &names[..width])
        })?;
        let of = |first: usize| {
            let columns = first..first + width;
            let mut table = self.clone();
            let others = (0..names.len()).filter(|column| !columns.contains(column));
            others.for_each(|column| table.labels[column].clear());
            // A shorter record ends in empty cells.
            table.rows.retain(|row| {
                let mut own = row.cells.iter().skip(first).take(width);
                own.any(|cell| !cell.is_empty())
            });
            table
        };
        Some((0..names.len()).step_by(width).map(of).collect())
    }

    /// The number in a cell, or its text if it is not a finite number.
    pub(crate) fn number<'a>(&self, row: &'a TextRow, column: usize) -> Result<f64, &'a str> {
        let text = row.cells.get(column).map_or("", String::as_str);
        self.style.number(text).ok_or(text)
    }

    /// A number to the right of the last column: a sign in another number separates the cells.
    pub(crate) fn beyond<'a>(&self, row: &'a TextRow) -> Option<&'a str> {
        let mut cells = row.cells.iter().skip(self.labels.len());
        let cell = cells.find(|cell| self.style.number(cell).is_some())?;
        Some(cell)
    }

    /// A row in which the decimal sign of a column separates thousands: 999 is followed by 1.003,
    /// and all numbers with the sign have three digits after it.
    pub(crate) fn thousands(&self, column: usize) -> Option<&TextRow> {
        let sign = if self.style.comma { ',' } else { '.' };
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

/// Index and number of cells of the first row of numbers. It has as many cells and numbers as most
/// rows, so that a preamble with two numbers in a line is not taken for the table.
fn first_row(rows: &[TextRow], style: NumberStyle) -> Option<(usize, usize)> {
    let shape = |row: &TextRow| {
        if row.is_comment() { (0, 0) } else { (row.cells.len(), row.numbers(style)) }
    };
    let mut shapes: Vec<_> = rows.iter().map(shape).filter(|(_, numbers)| *numbers > 0).collect();
    shapes.sort_unstable();
    let usual = shapes.chunk_by(PartialEq::eq).max_by_key(|same| same.len())?[0];
    let start = rows.iter().position(|row| shape(row) == usual)?;
    Some((start, usual.0))
}

/// The cells of a line above the table, which may be a comment.
fn words(row: &TextRow) -> Vec<String> {
    let cells = row.cells.iter();
    cells.map(|cell| cell.trim_start_matches('#').trim().to_owned()).collect()
}

fn has_units(row: &TextRow) -> bool {
    are_units(&words(row))
}

/// Name and unit of each column from the lines above the first row of numbers.
fn labels(above: &[TextRow], width: usize, style: NumberStyle) -> Result<Vec<String>, String> {
    let mut lines = above.iter().rev().map(words).peekable();
    let units = lines.next_if(|cells| are_units(cells));
    let mut names = lines.next().unwrap_or_default();
    let units = units.or_else(|| lines.next_if(|cells| are_units(cells))).unwrap_or_default();
    if width == 2 * names.len() && names.iter().all(|name| Name::of(name).quantity().is_some()) {
        return Err(format!(
            "names {} columns, but the rows have {width} cells: if the comma is the decimal sign, save the \
             file with semicolons between the columns",
            names.len()
        ));
    }
    let named = names.len() == width && names.iter().all(|name| style.number(name).is_none());
    if !named {
        names = vec![String::new(); width];
    }
    if named || units.len() == width {
        for (name, unit) in names.iter_mut().zip(&units).filter(|(_, unit)| !bare(unit).is_empty())
        {
            *name = format!("{name} ({})", bare(unit)).trim().to_owned();
        }
    }
    Ok(names)
}

/// Why a text contains no table.
fn no_table(text: &str) -> String {
    let [styles, _] = NumberStyle::ALL;
    if text.lines().any(|line| styles.iter().any(|style| style.number(line).is_some())) {
        return "has one column of numbers: a tensile curve needs two, force or stress and extension or strain, separated \
                by commas, semicolons or tabs"
            .into();
    }
    let digits = |(line, _): &(&str, i32)| line.contains(|c: char| c.is_ascii_digit());
    let last = text.lines().zip(1..).filter(digits).last();
    let quoted =
        last.map(|(line, number)| format!(" (line {number} is `{}`)", line.escape_debug()));
    format!(
        "has no rows of numbers{}: save the curve as text, in columns of plain numbers separated by commas, \
         semicolons or tabs, with the units in the names of the columns",
        quoted.unwrap_or_default()
    )
}

// The dimensions of a specimen that a testing machine writes above its table: `Width;10,0;mm`,
// `Largeur (mm): 10`.

/// A dimension of a specimen that its file states.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, derive_more::Display)]
#[display("{} {value} mm (line {line})", name.replace('-', " "))]
pub struct StatedDimension {
    /// Which: the option of the command line without its dashes.
    pub name: &'static str,
    /// Its value (mm).
    pub value: f64,
    /// Number of the line in the file, from 1.
    pub line: u64,
}

/// The dimensions in the lines above a table, and the lines that name one and state none of the
/// specimen: the width of a layer or of the grips, several numbers in a line, several values of one
/// dimension.
pub(super) fn dimensions(
    lines: &[TextRow],
    style: NumberStyle,
) -> (Vec<StatedDimension>, Vec<String>) {
    let (mut stated, mut others) = (Vec::<StatedDimension>::new(), Vec::new());
    for row in lines {
        let Some((text, values)) = named_values(row) else { continue };
        let name = Name::of(text);
        match dimension(&name, &values, style) {
            Some((name, value)) => stated.push(StatedDimension { name, value, line: row.line }),
            None if name.is_near_dimension() => others.push(format!("line {} `{text}`", row.line)),
            None => {}
        }
    }
    let one_value = |one: &StatedDimension| {
        stated.iter().all(|other| other.name != one.name || other.value == one.value)
    };
    let (used, several): (Vec<_>, Vec<_>) = stated.iter().partition(|one| one_value(one));
    others.extend(several.iter().map(|one| format!("{one}, one of several values")));
    (used, others)
}

/// The dimension of a specimen that a line states (mm).
fn dimension(name: &Name, values: &[&str], style: NumberStyle) -> Option<(&'static str, f64)> {
    let numbers = values.iter().enumerate();
    let mut numbers = numbers.filter_map(|(at, value)| Some((at, style.number(value)?)));
    let (at, number) = numbers.next().filter(|(_, number)| *number > 0.0)?;
    let unit = match values.get(at + 1).filter(|unit| !unit.is_empty()) {
        Some(unit) => bare(unit),
        None => name.unit(Extension).ok()?.unwrap_or("mm"),
    };
    let value = number * Extension.factor(unit)?;
    numbers.next().is_none().then_some((name.dimension()?, value))
}

/// The name in a line, and what stands behind it: behind a colon or an equals sign, and in other
/// cells.
fn named_values(row: &TextRow) -> Option<(&str, Vec<&str>)> {
    let name = row.cells[0].trim_start_matches('#').trim();
    let (name, value) = name.split_once([':', '=']).unwrap_or((name, ""));
    let words = value.split_whitespace().chain(row.cells[1..].iter().map(String::as_str));
    let values: Vec<&str> = words.collect();
    (!values.is_empty()).then_some((name, values))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_preamble_is_kept_and_a_row_of_units_is_joined_to_the_names() {
        let text = "Specimen;3\nWidth;10,0;mm\nDimensions;10,0;0,5\n\nTime;Load;Extension\n(s);(kN);[mm]\n\
                    0,0;0,0;0,0\n0,1;0,2;0,3\n";
        let tables = NumberTable::parse(text).unwrap();
        let [table] = &tables[..] else { panic!() };
        assert_eq!(table.labels, ["Time (s)", "Load (kN)", "Extension (mm)"]);
        let lines: Vec<u64> = table.rows.iter().map(|row| row.line).collect();
        assert_eq!(lines, [7, 8]);
        assert_eq!(table.number(&table.rows[1], 2), Ok(0.3));
        assert_eq!(table.preamble[1].cells, ["Width", "10,0", "mm"]);
        assert!(table.side_by_side().is_none());
    }

    #[test]
    fn specimens_below_each_other_and_side_by_side_are_told_apart() {
        let below = "Bar 1\nLoad,Way\nN,mm\n1,2\n3,4\nBar 2\nWidth,9\nLoad,Way\nN,mm\n5,6\n";
        let beside = "Bar 1,,Bar 2\nLoad 1 (N),Way 1 (mm),Load 2 (N),Way 2 (mm)\n1,2,5,6\n3,4,,\n";
        let tables = NumberTable::parse(below).unwrap();
        let side = NumberTable::parse(beside).unwrap()[0].side_by_side().unwrap();
        for tables in [&tables, &side] {
            let rows: Vec<usize> = tables.iter().map(|table| table.rows.len()).collect();
            assert_eq!(rows, [2, 1]);
        }
        assert_eq!(tables[1].number(&tables[1].rows[0], 0), Ok(5.0));
        assert_eq!(tables[1].preamble[1].cells, ["Width", "9"]);
        assert_eq!(side[1].labels, ["", "", "Load 2 (N)", "Way 2 (mm)"]);
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

#[cfg(test)]
mod preamble_tests {
    use super::*;
    use support::text_table::TextTable;

    fn above_a_table(line: &str) -> Vec<StatedDimension> {
        let separator = if line.contains(';') { ";" } else { "," };
        let table = TextTable::parse(&format!("{line}\n1{separator}2\n3{separator}4\n"));
        dimensions(&table.rows[..1], table.style).0
    }

    #[test]
    fn dimensions_are_found_in_the_words_of_machines() {
        for (text, name, value) in [
            ("Width,10.5,mm", "width", 10.5),
            ("\"Épaisseur éprouvette\",0.5,\"mm\"", "thickness", 0.5),
            ("Probenbreite b0;10;mm", "width", 10.0),
            ("Gauge length (in),2", "gauge-length", 50.8),
            ("L0 - course standard,50,mm", "gauge-length", 50.0),
            ("# Thickness: 500 um", "thickness", 0.5),
            ("Spessore = 3", "thickness", 3.0),
        ] {
            let found = above_a_table(text);
            let [one] = found[..] else { panic!("{text}: {found:?}") };
            assert_eq!((one.name, one.line), (name, 1), "{text}");
            assert!((one.value - value).abs() < 1e-12, "{text}: {one:?}");
        }
        for text in ["Width,10,11,12", "Width", "Load,12,N", "Width,0"] {
            assert_eq!(above_a_table(text), [], "{text}");
        }
    }

    /// Each is named, and none is taken for the specimen's.
    #[test]
    fn dimensions_of_other_things_are_not_taken() {
        for text in [
            "Bandwidth,50,Hz",
            "Layer thickness (mm),0.2",
            "Wandstärke;1,2;mm",
            "Enddicke;2,1;mm",
            "Thickness tolerance,0.1,mm",
            "Thickness of coating,12,um",
            "Extrusion width: 0.42 mm",
            "Grip width,25,mm",
            "Largeur des mors,25,mm",
            "Gauge length after fracture,72,mm",
            "Grip length,90,mm",
            "Spessore finale = 3",
            "Width (furlongs),10",
        ] {
            let separator = if text.contains(';') { ";" } else { "," };
            let table = TextTable::parse(&format!("{text}\n1{separator}2\n3{separator}4\n"));
            let (stated, others) = dimensions(&table.rows[..1], table.style);
            assert_eq!((stated.len(), others.len()), (0, 1), "{text}");
            assert!(others[0].starts_with("line 1 `"), "{others:?}");
        }
    }
}
