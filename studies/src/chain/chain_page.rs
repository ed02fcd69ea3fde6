//! The tables and the chart of the study.

use super::{NETWORK, Row, WINDOW_TIER};
use crate::charts::{self, FrontPanel};
use anyhow::Result;
use kirigami::ui::{picture, run_folder};
use std::path::Path;
use support::table::{Cell, Table};

/// `outline`: the distance of the reference's design from the target (mm).
pub(super) fn write(out: &Path, outline: f64, rows: &[Row], failures: &str) -> Result<()> {
    let table = format!(
        "The reference takes the most accurate option of every choice; its design meets the target to {outline:.2} mm (root \
         mean square). *Prediction*: that design, deployed with the choice; differences from the reference are root \
         mean squares over the panel corners, the hinges' rotations, their forces F_a and F_s, and their maximum \
         damage. *Design*: the design made with the choice; its distance from the target as predicted with the \
         choice, and as computed with the reference. Windows: CPU time of the windows that the network was trained \
         on. Training: wall time. Step: CPU time of one evaluation of the loss and its gradient. `kirigami-studies \
         chain`.\n\n{}",
        columns().markdown(rows)
    );
    let mut page = format!("# The whole chain on one sheet\n\n{table}\n");
    if !failures.is_empty() {
        page += &format!("No result:\n\n{failures}\n");
    }
    page += "![cost and error](chain.png)\n";
    run_folder::write(out, "chain.csv", &columns().csv(rows))?;
    run_folder::write(out, "chain.md", &page)?;
    let tradeoff = format!("## The whole chain\n\n{table}");
    run_folder::write(out, "tradeoff.md", &tradeoff)?;
    let chart = charts::front(&[
        front(rows, "windows and training", |row| {
            is_trained(row).then_some(row.windows_s? + row.training_s?)
        }),
        front(rows, "one step of the design", |row| Some(row.step_s)),
    ])?;
    let pictures = picture::save(&chart, &out.join("chain"), 1800)?;
    println!("{page}\n{} choices; {}", rows.len(), pictures[1].display());
    Ok(())
}

/// Whether the choice is a network.
fn is_trained(row: &Row) -> bool {
    [NETWORK, WINDOW_TIER].contains(&row.kind)
}

fn front(rows: &[Row], title: &'static str, cost: fn(&Row) -> Option<f64>) -> FrontPanel {
    let point = |row: &Row| {
        let name = if is_trained(row) {
            row.choice.clone()
        } else {
            format!("{} {}", row.kind, row.choice)
        };
        Some((name, cost(row)?, 100.0 * row.prediction.shape[1]))
    };
    let points = rows.iter().filter_map(point).collect();
    FrontPanel { title, points }
}

fn columns<'a>() -> Table<'a, Row> {
    let hours = |seconds: f64| Cell::number(seconds, format!("{:.2} h", seconds / 3600.0));
    let seconds = |seconds: f64| Cell::number(seconds, format!("{seconds:.0} s"));
    Table::new()
        .column("choice", |row: &Row| Cell::text(row.kind))
        .column("", |row| Cell::text(&row.choice))
        .column("windows", move |row| {
            Cell::known(row.windows_s.map(hours), "-")
        })
        .column("training", move |row| {
            Cell::known(row.training_s.map(seconds), "-")
        })
        .column("step, ms", |row| Cell::fixed(1e3 * row.step_s, 2))
        .column("shape, mm", |row| Cell::fixed(row.prediction.shape[0], 3))
        .column("% of the sheet", |row| {
            Cell::percent(row.prediction.shape[1], 4)
        })
        .column("rotation, deg", |row| {
            Cell::fixed(row.prediction.rotation_deg, 3)
        })
        .column("force", |row| Cell::percent(row.prediction.force, 2))
        .column("damage", |row| {
            let damage = row.prediction.damage;
            Cell::known(damage.map(|error| Cell::percent(error, 2)), "-")
        })
        .column("outline, predicted, mm", |row| {
            Cell::fixed(row.outline[0], 2)
        })
        .column("by reference, mm", |row| Cell::fixed(row.outline[1], 2))
        .column("maximum D", |row| Cell::fixed(row.damage, 4))
}
