//! The scene of a sheet that opens onto a drawing: what the fit has chosen, written into the first
//! scene.

use crate::fitting::fit_to_target;
use crate::new_project::edited::{heading, set};
use anyhow::{Context, Result};
use scene::{Posture, Scene, SceneConfig, TargetShape};
use toml_edit::{Array, ArrayOfTables, DocumentMut, Item, Table, Value, value};

/// The text of the scene of a first sheet, fitted to its target, and what is expected of it.
pub(super) fn fitted_text(scene: &Scene, text: &str) -> Result<(String, String)> {
    let (fit, expected) = fit_to_target(scene)?;
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
    let SceneConfig { objective, optimiser, posture, .. } = &fit.config;
    let mut held = Table::new();
    held["kind"] = value(match posture.map(|posture| posture.kind) {
        Some(Posture::Lying) => "lying",
        _ => "held-flat",
    });
    document["posture"] = Item::Table(held);
    let weights = &mut document["objective"];
    set(&mut weights["damage"], objective.damage);
    set(&mut weights["domain"], objective.domain);
    weights["symmetric_difference"] = value(objective.symmetric_difference);
    weights["damage_measure"] = value("peak");
    set(&mut document["optimiser"]["steps"], optimiser.steps as i64);
    set(&mut document["optimiser"]["learning_rate"], optimiser.learning_rate);
    Ok((document.to_string(), expected))
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
    if let TargetShape::Svg { file, centre, height, rotation_deg } = target {
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        set(&mut document["title"], &*name);
        let svg = &mut document["target"]["svg"];
        svg["centre"] = value(numbers(centre));
        set(&mut svg["height"], height.unwrap_or_default());
        svg["rotation_deg"] = value(*rotation_deg);
    }
}

fn numbers(values: &[f64]) -> Value {
    Array::from_iter(values.iter().copied()).into()
}
