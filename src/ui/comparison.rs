//! Tables that compare several runs, as files and on the screen.

use crate::ui::{self, run_folder};
use anyhow::Result;
use std::path::Path;
use support::table::{Cell, Table};

/// Writes `NAME.csv` and `NAME.md`, one line a row, to `folder`, and returns the table.
pub fn write<const N: usize>(
    folder: &Path,
    name: &str,
    columns: [&str; N],
    rows: impl IntoIterator<Item = [String; N]>,
) -> Result<ui::table::Table> {
    let rows: Vec<[String; N]> = rows.into_iter().collect();
    let table = (columns.iter().enumerate()).fold(Table::new(), |table, (i, name)| {
        table.column(*name, move |cells: &[String; N]| Cell::text(&cells[i]))
    });
    run_folder::write(folder, &format!("{name}.csv"), &table.csv(&rows))?;
    run_folder::write(folder, &format!("{name}.md"), &table.markdown(&rows))?;
    let mut listed = ui::table::table(columns);
    for cells in rows {
        listed.add_row(cells);
    }
    Ok(listed)
}
