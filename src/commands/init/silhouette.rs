//! The scene of a sheet that opens onto a drawing: what the fit has chosen, written into the first scene.

use crate::commands::init::edited::{heading, set};
use crate::ui::progress::announce;
use anyhow::{Context, Result};
use design::fit::scene::{FittedScene, Nearness, fitted};
use design::scene::{Posture, Scene, SceneConfig, TargetShape};
use toml_edit::{Array, ArrayOfTables, DocumentMut, Item, Table, Value, value};

/// The text of the scene of a first sheet, fitted to its target, and what is expected of it.
pub(super) fn fitted_text(scene: &Scene, text: &str) -> Result<(String, String)> {
    announce("fitting the sheet and the drawing to each other, in some seconds");
    let fit = fitted(scene)?;
    let mut document: DocumentMut = text.parse().context("the first scene is valid TOML")?;
    heading(
        &mut document,
        "# A sheet that opens onto a drawing, written by `kirigami init --target`. Its outline, its cuts, the panels that are pulled\n\
         # and the place of the drawing were chosen on pins, then its equilibrium was computed; `kirigami design` goes on from there.\n\
         # Its middle panel is held; the others are pulled along straight lines, as on a table, and fastened at the end.\n\
         # Lengths in mm, forces in N, couples in N mm; paths are relative to this file.\n\n",
    );
    write_sheet(&mut document, &fit.config);
    write_pulls(&mut document, &fit.config);
    write_target(&mut document, &fit.config.target);
    let SceneConfig {
        objective,
        optimiser,
        posture,
        ..
    } = &fit.config;
    let mut held = Table::new();
    held["kind"] = value(match posture.map(|posture| posture.kind) {
        Some(Posture::Lying) => "lying",
        _ => "held-flat",
    });
    document["posture"] = Item::Table(held);
    let weights = &mut document["objective"];
    weights["symmetric_difference"] = value(objective.symmetric_difference);
    weights["damage_measure"] = value("peak");
    set(&mut document["optimiser"]["steps"], optimiser.steps as i64);
    set(
        &mut document["optimiser"]["learning_rate"],
        optimiser.learning_rate,
    );
    Ok((document.to_string(), expected(&fit)))
}

fn write_sheet(document: &mut DocumentMut, config: &SceneConfig) {
    let sheet = &mut document["sheet"];
    if let Some(sheet) = sheet.as_table_mut() {
        sheet.remove("size");
    }
    let corners = config.sheet.corners.iter().flatten();
    let corners: Array = corners.map(|corner| numbers(corner)).collect();
    sheet["corners"] = value(corners);
    let panels = config.sheet.panels.map(|count| count as i64);
    set(&mut sheet["panels"], Array::from_iter(panels));
    let mut start = Table::new();
    start.decor_mut().set_prefix("\n# The cuts of the fit.\n");
    start["r"] = value(numbers(config.start.r.as_deref().unwrap_or_default()));
    let tau = config.start.tau.iter().flatten();
    start["w_lig"] = value(numbers(config.start.w_lig.as_deref().unwrap_or_default()));
    start["tau"] = value(tau.map(|edge| numbers(edge)).collect::<Array>());
    document["start"] = Item::Table(start);
}

fn write_pulls(document: &mut DocumentMut, config: &SceneConfig) {
    let panel = |[column, row]: [usize; 2]| value(Array::from_iter([column as i64, row as i64]));
    let mut supports = ArrayOfTables::new();
    for support in &config.supports {
        let mut table = Table::new();
        table["panel"] = panel(support.panel);
        table["kind"] = value("clamp");
        supports.push(table);
    }
    let mut loads = ArrayOfTables::new();
    for load in &config.loads {
        let mut table = Table::new();
        table["panel"] = panel(load.panel);
        table["force"] = value(numbers(&load.force));
        loads.push(table);
    }
    document["supports"] = Item::ArrayOfTables(supports);
    document["loads"] = Item::ArrayOfTables(loads);
    if let Some(drive) = config.drive {
        set(&mut document["drive"]["stroke"], drive.stroke);
    }
}

fn write_target(document: &mut DocumentMut, target: &TargetShape) {
    if let TargetShape::Svg {
        file,
        centre,
        height,
        rotation_deg,
    } = target
    {
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        set(&mut document["title"], &*name);
        let svg = &mut document["target"]["svg"];
        svg["centre"] = value(numbers(centre));
        svg["height"] = value(*height);
        svg["rotation_deg"] = value(*rotation_deg);
    }
}

fn numbers(values: &[f64]) -> Value {
    Array::from_iter(values.iter().copied()).into()
}

/// What a person may expect of the sheet.
fn expected(fit: &FittedScene) -> String {
    let [columns, rows] = fit.config.sheet.panels;
    let within = |Nearness {
                      error,
                      relative,
                      overlap,
                  }: Nearness| {
        format!(
            "within {error:.1} mm, {:.1} % of the sheet; {:.1} % of the area in common",
            100.0 * relative,
            100.0 * overlap
        )
    };
    let pulled = match (fit.pulled, fit.config.loads.len()) {
        (None, _) => "no equilibrium under pulls was found".to_owned(),
        (Some(near), 1) => format!("pulled at one panel, before the search: {}", within(near)),
        (Some(near), count) => format!(
            "pulled at {count} panels, before the search: {}",
            within(near)
        ),
    };
    format!(
        "The sheet of {columns} x {rows} panels, opened by {:.0} deg, becomes the drawing\n  on pins: {}\n  {pulled}",
        fit.opening.to_degrees(),
        within(fit.on_pins)
    )
}
