//! The tables and the chart of the study.

use super::{Deployed, NETWORK, Row, WINDOW_TIER};
use crate::charts::{self, FrontPanel};
use anyhow::Result;
use kirigami::ui::{picture, run_folder};
use std::fmt::Write;
use std::path::Path;

pub(super) fn write(out: &Path, truth: &Deployed, rows: &[Row], failures: &str) -> Result<()> {
    run_folder::write(out, "chain.csv", &csv(rows)?)?;
    let table = table(truth, rows)?;
    let mut page = format!("# The whole chain on one sheet\n\n{table}\n");
    if !failures.is_empty() {
        page += &format!("No result:\n\n{failures}\n");
    }
    page += "![cost and error](chain.png)\n";
    run_folder::write(out, "chain.md", &page)?;
    run_folder::write(
        out,
        "tradeoff.md",
        &format!("## The whole chain\n\n{table}"),
    )?;
    let front = |title, cost: fn(&Row) -> Option<f64>| FrontPanel {
        title,
        points: rows
            .iter()
            .filter_map(|row| {
                let name = match row.kind {
                    NETWORK | WINDOW_TIER => row.choice.clone(),
                    kind => format!("{kind} {}", row.choice),
                };
                Some((name, cost(row)?, 100.0 * row.prediction.shape[1]))
            })
            .collect(),
    };
    let chart = charts::front(&[
        front("windows and training", |row| {
            let trained = [NETWORK, WINDOW_TIER].contains(&row.kind);
            trained.then_some(row.windows_s? + row.training_s?)
        }),
        front("one step of the design", |row| Some(row.step_s)),
    ])?;
    let pictures = picture::save(&chart, &out.join("chain"), 1800)?;
    println!("{page}\n{} choices; {}", rows.len(), pictures[1].display());
    Ok(())
}

fn table(truth: &Deployed, rows: &[Row]) -> Result<String> {
    let mut text = format!(
        "The reference takes the most accurate option of every choice; its design meets the target to {:.2} mm (root \
         mean square). *Prediction*: that design, deployed with the choice; differences from the reference are root \
         mean squares over the panel corners, the hinges' rotations, their forces F_a and F_s, and their maximum \
         damage. *Design*: the design made with the choice; its distance from the target as predicted with the \
         choice, and as computed with the reference. Windows: CPU time of the windows that the network was trained \
         on. Training: wall time. Step: time of one evaluation of the loss and its gradient. `kirigami-studies \
         chain`.\n\n\
         | choice | | windows | training | step, ms | shape, mm | % of the sheet | rotation, deg | \
         force | damage | outline, predicted, mm | by reference, mm | maximum D |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
        truth.outline
    );
    for row in rows {
        let hours = |seconds: f64| format!("{:.2} h", seconds / 3600.0);
        let seconds = |seconds: f64| format!("{seconds:.0} s");
        let given = |value: Option<String>| value.unwrap_or_else(|| "-".into());
        let percent = |fraction: f64| format!("{:.2} %", 100.0 * fraction);
        let found = &row.prediction;
        let [predicted, actual] = row.outline;
        writeln!(
            text,
            "| {} | {} | {} | {} | {:.2} | {:.3} | {:.4} % | {:.3} | {} | {} | {predicted:.2} | \
             {actual:.2} | {:.4} |",
            row.kind,
            row.choice,
            given(row.windows_s.map(hours)),
            given(row.training_s.map(seconds)),
            1e3 * row.step_s,
            found.shape[0],
            100.0 * found.shape[1],
            found.rotation_deg,
            percent(found.force),
            given(found.damage.map(percent)),
            row.damage
        )?;
    }
    Ok(text)
}

fn csv(rows: &[Row]) -> Result<String> {
    let mut text =
        "kind,choice,windows_s,training_s,step_s,shape_mm,shape_over_sheet,rotation_deg,\
        force,damage,outline_predicted_mm,outline_mm,greatest_d\n"
            .to_owned();
    for row in rows {
        let given = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.5}"));
        let found = &row.prediction;
        let [predicted, actual] = row.outline;
        writeln!(
            text,
            "{},\"{}\",{},{},{:.6},{:.6e},{:.6e},{:.6e},{:.6e},{},{predicted:.5},{actual:.5},{:.6}",
            row.kind,
            row.choice,
            given(row.windows_s),
            given(row.training_s),
            row.step_s,
            found.shape[0],
            found.shape[1],
            found.rotation_deg,
            found.force,
            given(found.damage),
            row.damage
        )?;
    }
    Ok(text)
}
