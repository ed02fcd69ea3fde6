//! Tables as Markdown and CSV: a column is said once, as its heading and how a cell follows from a row. Printed tables have
//! aligned columns.

use std::fmt::Display;

/// A cell: what a page shows, and what a CSV file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    shown: String,
    /// The unrounded number, if it is one; empty if it is not known.
    stored: String,
}

impl Cell {
    /// What a page and a file show alike. A text is not more than a text: none begins another cell or row of a page, and
    /// none is computed as a formula by a spreadsheet.
    pub fn text(text: impl Display) -> Self {
        let text = text.to_string();
        Self {
            shown: text.replace('|', "\\|").replace(['\r', '\n'], " "),
            stored: no_formula(text),
        }
    }

    /// A number with a fixed number of decimals on a page.
    pub fn fixed(value: f64, decimals: usize) -> Self {
        Self::number(value, format!("{value:.decimals$}"))
    }

    /// A fraction, shown in per cent; a file holds the fraction.
    pub fn percent(fraction: f64, decimals: usize) -> Self {
        let percent = 100.0 * fraction;
        Self::number(fraction, format!("{percent:.decimals$} %"))
    }

    /// A number with its own text on a page.
    pub fn number(value: f64, shown: impl Into<String>) -> Self {
        let (shown, stored) = (shown.into(), value.to_string());
        Self { shown, stored }
    }

    /// Shown as `absent` and stored as an empty cell if not known.
    pub fn known(cell: Option<Self>, absent: &str) -> Self {
        cell.unwrap_or_else(|| Self {
            shown: absent.to_owned(),
            stored: String::new(),
        })
    }
}

struct Column<'a, R> {
    heading: String,
    cell: Box<dyn Fn(&R) -> Cell + 'a>,
}

/// The columns of a table of rows `R`.
pub struct Table<'a, R> {
    columns: Vec<Column<'a, R>>,
}

impl<R> Default for Table<'_, R> {
    fn default() -> Self {
        Self {
            columns: Vec::new(),
        }
    }
}

impl<'a, R> Table<'a, R> {
    /// A table without columns.
    pub fn new() -> Self {
        Self::default()
    }

    /// The table with a further column on the right.
    #[must_use]
    pub fn column(mut self, heading: impl Into<String>, cell: impl Fn(&R) -> Cell + 'a) -> Self {
        let (heading, cell) = (heading.into(), Box::new(cell));
        self.columns.push(Column { heading, cell });
        self
    }

    /// The table in Markdown, one line a row.
    pub fn markdown<'r>(&self, rows: impl IntoIterator<Item = &'r R>) -> String
    where
        R: 'r,
    {
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let mut text = line(
            self.columns
                .iter()
                .map(|column| column.heading.clone())
                .collect(),
        );
        text += &format!("|{}\n", "---|".repeat(self.columns.len()));
        for row in rows {
            text += &line(self.cells(row).map(|cell| cell.shown).collect());
        }
        text
    }

    /// The table as CSV with one line of headings.
    pub fn csv<'r>(&self, rows: impl IntoIterator<Item = &'r R>) -> String
    where
        R: 'r,
    {
        let mut text = csv_line(self.columns.iter().map(|column| column.heading.as_str()));
        for row in rows {
            let stored: Vec<String> = self.cells(row).map(|cell| cell.stored).collect();
            text += &csv_line(stored.iter().map(String::as_str));
        }
        text
    }

    fn cells(&self, row: &R) -> impl Iterator<Item = Cell> {
        self.columns.iter().map(|column| (column.cell)(row))
    }
}

/// The text, after an apostrophe if a spreadsheet would compute it. A number or a single dash is none that it computes.
fn no_formula(text: String) -> String {
    let computed = text.starts_with(['=', '+', '-', '@', '\t', '\r']);
    if computed && text.len() > 1 && text.parse::<f64>().is_err() {
        format!("'{text}")
    } else {
        text
    }
}

/// A line of CSV; cells with commas, quotes or line breaks stand in quotes.
fn csv_line<'c>(cells: impl Iterator<Item = &'c str>) -> String {
    let quoted = cells.map(|cell| {
        if cell.contains([',', '"', '\n', '\r']) {
            format!("\"{}\"", cell.replace('"', "\"\""))
        } else {
            cell.to_owned()
        }
    });
    quoted.collect::<Vec<_>>().join(",") + "\n"
}

/// Rows as lines of columns that are as wide as their widest cell, with `gap` between them; those that are not `left` are
/// aligned right.
pub fn aligned(rows: &[Vec<String>], left: impl Fn(usize) -> bool, gap: &str) -> Vec<String> {
    let count = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..count).map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = std::iter::zip(row, &widths).enumerate();
        let cells = cells.map(|(column, (cell, width))| match left(column) {
            true => format!("{cell:<width$}"),
            false => format!("{cell:>width$}"),
        });
        cells.collect::<Vec<_>>().join(gap)
    };
    rows.iter().map(line).collect()
}

/// A number with a fixed number of decimals; `-` if it is not known (NaN).
pub fn number_or_dash(value: f64, decimals: usize) -> String {
    if value.is_nan() {
        "-".into()
    } else {
        format!("{value:.decimals$}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_one_cell_of_a_page_and_no_formula_of_a_spreadsheet() {
        let table = Table::new()
            .column("name", |row: &&str| Cell::text(row))
            .column("length", |row| Cell::text(row.len()));
        let texts = [
            ("a|b", "a\\|b", "a|b"),
            ("a\n| b", "a \\| b", "\"a\n| b\""),
            ("a\rb", "a b", "\"a\rb\""),
            ("=1+1", "=1+1", "'=1+1"),
            ("+cmd", "+cmd", "'+cmd"),
            ("-cmd", "-cmd", "'-cmd"),
            ("@SUM(A1)", "@SUM(A1)", "'@SUM(A1)"),
            ("\t=1", "\t=1", "'\t=1"),
            ("-", "-", "-"),
            ("-1.5e3", "-1.5e3", "-1.5e3"),
        ];
        for (text, shown, stored) in texts {
            let length = text.len();
            let page = table.markdown(&[text]);
            let last = format!("| {shown} | {length} |\n");
            assert!(page.ends_with(&last), "{page}");
            assert_eq!(page.lines().count(), 3);
            let file = table.csv(&[text]);
            assert_eq!(file, format!("name,length\n{stored},{length}\n"));
        }
    }

    #[test]
    fn a_page_rounds_and_a_file_does_not() {
        let table = Table::new()
            .column("choice", |row: &(&str, f64)| Cell::text(row.0))
            .column("W, N mm", |row| Cell::fixed(row.1, 1))
            .column("error", |row| {
                Cell::known((row.1 < 1.0).then(|| Cell::percent(row.1, 0)), "-")
            });
        let rows = [("a, b", 0.25), ("c", 2.0)];
        let page =
            "| choice | W, N mm | error |\n|---|---|---|\n| a, b | 0.2 | 25 % |\n| c | 2.0 | - |\n";
        assert_eq!(table.markdown(&rows), page);
        let file = "choice,\"W, N mm\",error\n\"a, b\",0.25,0.25\nc,2,\n";
        assert_eq!(table.csv(&rows), file);
    }
}
