//! Printed tables: a rule under the header and no other lines.

use std::fmt::{self, Display, Formatter};
use support::table::aligned;

/// A table; the first column aligned left, the others right.
pub struct Table {
    /// Number of lines of the header.
    header: usize,
    rows: Vec<Vec<String>>,
}

/// An empty table. The names of its columns may have several lines.
pub fn table<const N: usize>(header: [&str; N]) -> Table {
    let lines = header.map(|name| name.lines().count());
    let lines = lines.into_iter().max().unwrap_or(0);
    let line = |i| header.map(|name| name.lines().nth(i).unwrap_or("").to_owned());
    Table {
        header: lines,
        rows: (0..lines).map(|i| line(i).to_vec()).collect(),
    }
}

impl Table {
    /// Adds a row.
    pub fn add_row(&mut self, cells: impl IntoIterator<Item = String>) {
        let cells = cells.into_iter().map(|cell| cell.replace('\n', " "));
        self.rows.push(cells.collect());
    }
}

impl Display for Table {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let mut lines = aligned(&self.rows, |column| column == 0, "   ");
        let rule = lines.first().map_or(0, |line| line.chars().count());
        lines
            .iter_mut()
            .for_each(|line| *line = format!(" {line} "));
        lines.insert(self.header, "\u{2500}".repeat(rule + 2));
        f.write_str(&lines.join("\n"))
    }
}
