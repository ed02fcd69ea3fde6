//! Printed tables: a rule under the header and no other lines.

use comfy_table::{CellAlignment, Table, TableComponent, presets};

/// A number with a fixed number of decimals; `-` if it is not known (NaN).
pub fn number_or_dash(value: f64, decimals: usize) -> String {
    if value.is_nan() {
        "-".into()
    } else {
        format!("{value:.decimals$}")
    }
}

/// An empty table; the first column aligned left, the others right.
pub fn table<const N: usize>(header: [&str; N]) -> Table {
    let mut table = Table::new();
    table.load_preset(presets::NOTHING).set_header(header);
    for rule in [
        TableComponent::HeaderLines,
        TableComponent::MiddleHeaderIntersections,
    ] {
        table.set_style(rule, '─');
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}
