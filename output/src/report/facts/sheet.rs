//! What the sheet is made of, its size, and the hashes of what a run depends on.

use super::{Fact, fact, number, text};
use crate::report::deployed::{Deployed, Run, extent};
use crate::report::numbers::rounded;
use analysis::unit::Unit;
use design::geometry::polygon::area;
use design::sheet::kinematics::deployed_corners;
use scene::Scene;

/// Mass of the uncut sheet (kg).
pub(in crate::report) fn mass_kg(scene: &Scene, outline: &[[f64; 2]; 4]) -> f64 {
    scene.material.mass_by_area() * area(outline).abs()
}

pub(super) fn material_and_size(of: &Deployed, _: &Run) -> Vec<Fact> {
    let (scene, sheet) = (of.scene, &of.deployment.sheet);
    let corners = deployed_corners(sheet, &of.deployment.final_step().configuration);
    let size = |names, size: [f64; 2], remark| {
        let [x, y] = size.map(|length| rounded(length, 5));
        fact(names, size, Unit::Millimetre, format!("{x} x {y} mm{remark}"))
    };
    let material = &scene.material;
    let thickness = rounded(material.thickness, 4);
    let panels @ [columns, rows] = scene.config.sheet.panels;
    let level = scene.config.level;
    let deployed = extent(corners.into_iter().flatten());
    vec![
        fact(
            ["material"; 2],
            &material.name,
            Unit::None,
            format!("{}, {thickness} mm thick", material.name),
        ),
        number(
            ["mass_kg", "mass"],
            mass_kg(scene, &sheet.outline.corners),
            4,
            Unit::Kilogram,
            ", uncut",
        ),
        fact(["panels"; 2], panels, Unit::None, format!("{columns} x {rows}")),
        size(["flat_size", "flat size"], of.flat_size(), ""),
        size(["deployed_size", "deployed size"], deployed, ", panels in the plane"),
        fact(["level"; 2], level, Unit::None, format!("{level}, {}", level.hinges())),
    ]
}

/// BLAKE3 hashes: the keys of the scene without title and run folder, the law of the material, the
/// points of the target, and everything that the predictions of the weights depend on.
pub(super) fn hashes(of: &Deployed, _: &Run) -> Vec<Fact> {
    let scene = of.scene;
    let short = |names, hash: String| {
        let short = hash.chars().take(16).collect::<String>();
        fact(names, hash, Unit::None, short)
    };
    let weights = scene.weights().map(|weights| weights.hash());
    (weights.map(|hash| short(["weights_hash", "hash of weights"], hash)).into_iter())
        .chain([
            short(["scene_hash", "hash of scene"], scene.hash()),
            short(["material_hash", "hash of material"], scene.material.law_hash()),
            short(["target_hash", "hash of target"], scene.target.hash()),
            text(["version", "kirigami"], env!("CARGO_PKG_VERSION").to_owned()),
        ])
        .collect()
}
