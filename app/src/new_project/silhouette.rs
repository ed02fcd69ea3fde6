//! The scene of a sheet that opens onto a drawing: what the fit has chosen, written into the first
//! scene.

use crate::{
    fitting::fit_to_target,
    new_project::edited::{heading, set},
};
use anyhow::{Context, Result};
use scene::{Scene, SceneConfig, TargetShape};
use toml_edit::{Array, DocumentMut, Item, value};

/// The text of the scene of a first sheet, fitted to its target, and what is expected of it.
pub(super) fn fitted_text(
    scene: &Scene,
    text: &str,
    side: Option<f64>,
    anyway: bool,
) -> Result<(String, String)> {
    let (fit, expected) = fit_to_target(scene, side, anyway)?;
    let mut document: DocumentMut = text.parse().context("the first scene is valid TOML")?;
    heading(
        &mut document,
        "# A sheet that opens onto a drawing, written by `kirigami init --target`: an even pattern laid over the drawing while\n\
         # open, trimmed to it. Fasteners hold some panels at their places in the opened sheet, free to turn; `kirigami design`\n\
         # computes the forces. Lengths in mm, forces in N, couples in N mm; paths are relative to this file.\n\n",
    );
    // Everything that the fit decides, as the keys of the scene are written.
    let SceneConfig { target, .. } = &fit.config;
    let mut written: DocumentMut = fit.config.to_toml()?.parse()?;
    for key in ["sheet", "posture", "supports", "loads", "drive", "objective"] {
        let is_empty = |item: &&Item| item.as_array().is_some_and(Array::is_empty);
        match written.get(key).filter(|item| !is_empty(item)) {
            Some(item) => document[key] = item.clone(),
            None => _ = document.remove(key),
        }
    }
    document["ligament"]["start"] = written["ligament"]["start"].clone();
    document["optimiser"]["steps"] = written["optimiser"]["steps"].clone();
    if let TargetShape::Svg { file, centre, height, rotation_deg } = target {
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        set(&mut document["title"], &*name);
        let svg = &mut document["target"]["svg"];
        svg["centre"] = value(Array::from_iter(centre.iter().copied()));
        set(&mut svg["height"], height.unwrap_or_default());
        svg["rotation_deg"] = value(*rotation_deg);
    }
    let mut cells = DocumentMut::new();
    cells.extend(written.remove_entry("cells"));
    Ok((format!("{document}\n{cells}"), expected))
}
