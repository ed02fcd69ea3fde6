//! Tables: on a screen with aligned columns, on a page in Markdown, in a file as CSV.

use crate::Joined;
use serde::{Serialize, Serializer};
use std::fmt::{self, Display};

/// Numbers below are shown with all digits before the point.
const WIDEST: f64 = 1e7;

/// A cell: what a screen and a page show, and what a CSV file holds.
#[derive(Debug)]
pub struct Cell {
    shown: String,
    /// The unrounded number, if it is one; empty if unknown.
    stored: String,
}

impl Cell {
    /// What all of them show alike. A text is not more than a text: none is computed as a formula
    /// by a spreadsheet.
    pub fn text(text: impl Display) -> Self {
        let shown = text.to_string();
        let stored = no_formula(shown.clone());
        Self { shown, stored }
    }

    /// A number with a fixed number of decimals, which a file holds unrounded; of a large one three
    /// digits are shown. `-` if unknown, `None` or NaN.
    pub fn fixed(value: impl Into<Option<f64>>, decimals: usize) -> Self {
        let value = value.into().filter(|value| !value.is_nan());
        let shown = |value: f64| match value.abs() < WIDEST {
            true => format!("{value:.decimals$}"),
            false => format!("{value:.2e}"),
        };
        let cell = value.map(|value| Self::number(value, shown(value)));
        Self::known(cell, "-")
    }

    /// A fraction, shown in per cent; a file holds the fraction. `-` if unknown.
    pub fn percent(fraction: impl Into<Option<f64>>, decimals: usize) -> Self {
        let fraction = fraction.into().filter(|fraction| !fraction.is_nan());
        let cell = fraction.map(|x| Self::number(x, format!("{:.decimals$} %", 100.0 * x)));
        Self::known(cell, "-")
    }

    /// A number with its own text on a page.
    pub fn number(value: f64, shown: impl Into<String>) -> Self {
        let (shown, stored) = (shown.into(), value.to_string());
        Self { shown, stored }
    }

    /// Shown as `absent` and stored as an empty cell if unknown.
    pub fn known(cell: Option<Self>, absent: &str) -> Self {
        cell.unwrap_or_else(|| Self { shown: absent.to_owned(), stored: String::new() })
    }
}

impl<T: Display> From<T> for Cell {
    fn from(text: T) -> Self {
        Self::text(text)
    }
}

impl Serialize for Cell {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.shown)
    }
}

/// A head and rows of as many cells. `Display` is for a screen.
#[derive(Debug, Default, Serialize)]
pub struct Table {
    /// The names of the columns; a name of several lines ends with its unit.
    head: Vec<String>,
    rows: Vec<Vec<Cell>>,
    /// The columns that a screen aligns left.
    #[serde(skip)]
    left: Vec<usize>,
}

impl Table {
    /// An empty table with the names of its columns. Without any name, a screen shows the rows
    /// alone.
    pub fn new<S: Into<String>>(head: impl IntoIterator<Item = S>) -> Self {
        Self { head: head.into_iter().map(S::into).collect(), rows: Vec::new(), left: vec![0] }
    }

    /// The table with columns that a screen aligns left; it is the first one otherwise.
    #[must_use]
    pub fn left(mut self, columns: &[usize]) -> Self {
        self.left = columns.to_vec();
        self
    }

    /// Adds a row.
    pub fn row<C: Into<Cell>>(&mut self, cells: impl IntoIterator<Item = C>) {
        self.rows.push(cells.into_iter().map(C::into).collect());
    }

    /// The rows, as a screen shows their cells.
    pub fn rows(&self) -> impl Iterator<Item = Vec<&str>> {
        let rows = self.rows.iter();
        rows.map(|row| row.iter().map(|cell| cell.shown.as_str()).collect())
    }

    /// The names of the columns on one line.
    fn names(&self) -> impl Iterator<Item = String> {
        let head = self.head.iter();
        head.map(|name| name.trim_end().replace('\n', ", "))
    }

    /// The table in Markdown, one line a row.
    pub fn markdown(&self) -> String {
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let mut text = line(self.names().map(|name| escaped(&name)).collect());
        text += &format!("|{}\n", "---|".repeat(self.head.len()));
        for row in &self.rows {
            text += &line(row.iter().map(|cell| escaped(&cell.shown)).collect());
        }
        text
    }

    /// The table as CSV with one line of headings.
    pub fn csv(&self) -> String {
        let names: Vec<String> = self.names().collect();
        let mut text = csv_line(names.iter().map(String::as_str));
        for row in &self.rows {
            text += &csv_line(row.iter().map(|cell| cell.stored.as_str()));
        }
        text
    }
}

impl Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        const GAP: &str = "   ";
        let head = self.head.iter().map(|name| name.lines().count());
        let head = head.max().unwrap_or(0);
        let of_head = |line| {
            let names = self.head.iter();
            names.map(move |name| name.lines().nth(line).unwrap_or("").to_owned())
        };
        let mut lines: Vec<Vec<String>> = (0..head).map(|line| of_head(line).collect()).collect();
        lines.extend(self.rows().map(|row| row.into_iter().map(one_line).collect()));
        let width = |column: usize| {
            let cells = lines.iter().filter_map(|line| line.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.head.len()).map(width).collect();
        let line = |cells: &Vec<String>| {
            let cells = std::iter::zip(cells, &widths).enumerate();
            let cells = cells.map(|(column, (cell, width))| {
                if self.left.contains(&column) {
                    format!("{cell:<width$}")
                } else {
                    format!("{cell:>width$}")
                }
            });
            format!(" {}", cells.collect::<Vec<_>>().join(GAP).trim_end())
        };
        let mut lines: Vec<String> = lines.iter().map(line).collect();
        if head > 0 {
            let gaps = GAP.len() * (widths.len() - 1);
            lines.insert(head, "\u{2500}".repeat(widths.iter().sum::<usize>() + gaps + 2));
        }
        f.write_str(&lines.join("\n"))
    }
}

struct Column<'a, R> {
    name: String,
    cell: Box<dyn Fn(&R) -> Cell + 'a>,
}

/// The columns of a table of rows `R`: a column is said once, as its name and how a cell follows
/// from a row.
pub struct Columns<'a, R> {
    columns: Vec<Column<'a, R>>,
}

impl<R> Default for Columns<'_, R> {
    fn default() -> Self {
        Self { columns: Vec::new() }
    }
}

impl<'a, R> Columns<'a, R> {
    /// No columns.
    pub fn new() -> Self {
        Self::default()
    }

    /// The columns with a further one on the right.
    #[must_use]
    pub fn column<C: Into<Cell>>(
        mut self,
        name: impl Into<String>,
        cell: impl Fn(&R) -> C + 'a,
    ) -> Self {
        self.columns
            .push(Column { name: name.into(), cell: Box::new(move |row| cell(row).into()) });
        self
    }

    /// The table of some rows.
    pub fn table<'r>(&self, rows: impl IntoIterator<Item = &'r R>) -> Table
    where
        R: 'r,
    {
        let mut table = Table::new(self.columns.iter().map(|column| column.name.as_str()));
        for row in rows {
            table.row(self.columns.iter().map(|column| (column.cell)(row)));
        }
        table
    }
}

/// A text on one line.
fn one_line(text: &str) -> String {
    text.replace(['\r', '\n'], " ")
}

/// A text that is one cell of a page.
fn escaped(text: &str) -> String {
    one_line(text).replace('|', "\\|")
}

/// The text, after an apostrophe if a spreadsheet would compute it. A number or a single dash is
/// none that it computes.
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
    quoted.joined(",") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_one_cell_of_a_page_and_no_formula_of_a_spreadsheet() {
        let columns = Columns::new()
            .column("name", |row: &&str| Cell::text(row))
            .column("length", |row| row.len());
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
            let table = columns.table(&[text]);
            let page = table.markdown();
            let last = format!("| {shown} | {length} |\n");
            assert!(page.ends_with(&last), "{page}");
            assert_eq!(page.lines().count(), 3);
            assert_eq!(table.csv(), format!("name,length\n{stored},{length}\n"));
        }
    }

    #[test]
    fn a_page_rounds_and_a_file_does_not() {
        let columns = Columns::new()
            .column("choice", |row: &(&str, f64)| Cell::text(row.0))
            .column("W, N mm", |row| Cell::fixed(row.1, 1))
            .column("error", |row| Cell::percent((row.1 < 1.0).then_some(row.1), 0));
        let table = columns.table(&[("a, b", 0.25), ("c", 2.0)]);
        let page =
            "| choice | W, N mm | error |\n|---|---|---|\n| a, b | 0.2 | 25 % |\n| c | 2.0 | - |\n";
        assert_eq!(table.markdown(), page);
        let file = "choice,\"W, N mm\",error\n\"a, b\",0.25,0.25\nc,2,\n";
        assert_eq!(table.csv(), file);
    }

    #[test]
    fn a_screen_aligns_columns_under_names_of_several_lines() {
        let mut table = Table::new(["hinge", "w_lig\nmm", "found by"]).left(&[2]);
        table.row(["0", "12.50", "law"]);
        table.row(["10", "7.25", "elements"]);
        let lines = [
            " hinge   w_lig   found by",
            "            mm",
            "──────────────────────────",
            "     0   12.50   law",
            "    10    7.25   elements",
        ];
        assert_eq!(table.to_string(), lines.join("\n"));
        assert!(table.markdown().starts_with("| hinge | w_lig, mm | found by |\n"));
        assert!(table.csv().starts_with("hinge,\"w_lig, mm\",found by\n"));
        let mut nameless = Table::new(["", ""]);
        nameless.row(["area", "1.00 mm^2"]);
        assert_eq!(nameless.to_string(), " area   1.00 mm^2");
    }

    #[test]
    fn columns_never_collide() {
        let extremes = [0.0, -1e300, 1e-300, 99_999.9, -1e5, f64::NAN, f64::MAX];
        let mut table = Table::new(["", "", ""]).left(&[]);
        for value in extremes {
            table.row([format!("{value:.3}"), format!("{value:.1e}"), "x".repeat(7)]);
        }
        let text = table.to_string();
        for (line, row) in std::iter::zip(text.lines(), table.rows()) {
            assert_eq!(line.split_whitespace().collect::<Vec<_>>(), row, "{text}");
            assert_eq!(line.len(), text.lines().next().unwrap().len(), "{text}");
        }
    }
}
