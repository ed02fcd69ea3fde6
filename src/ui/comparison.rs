//! Tables that compare several runs, as files and on the screen.

use crate::ui::run_folder;
use crate::ui::table::table;
use anyhow::Result;
use comfy_table::Table;
use std::path::Path;

/// Writes `NAME.csv` and `NAME.md`, one line a row, to `folder`, and returns the table.
pub fn write<const N: usize>(
    folder: &Path,
    name: &str,
    columns: [&str; N],
    rows: impl IntoIterator<Item = [String; N]>,
) -> Result<Table> {
    let mut csv = csv::Writer::from_writer(Vec::new());
    csv.write_record(columns)?;
    let rule = "---|".repeat(N);
    let mut page = format!("| {} |\n|{rule}\n", columns.join(" | "));
    let mut listed = table(columns);
    for cells in rows {
        csv.write_record(&cells)?;
        page += &format!("| {} |\n", cells.join(" | "));
        listed.add_row(cells);
    }
    let csv = String::from_utf8(csv.into_inner()?)?;
    run_folder::write(folder, &format!("{name}.csv"), &csv)?;
    run_folder::write(folder, &format!("{name}.md"), &page)?;
    Ok(listed)
}
