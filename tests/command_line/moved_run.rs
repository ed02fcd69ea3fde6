//! The folder of a run holds what its design depends on: it is replayed where scene, material and
//! weights are gone.

use crate::common::Workplace;
use serde_json::Value;

const SCENE: &str = "configs/scenes/pet-3x3.toml";

/// The folder `moved` of the run of a learned scene, without the files that the scene names.
fn moved_run() -> Workplace {
    let work = Workplace::new();
    // After two steps the report has errors.
    work.output(&format!("design {SCENE} --steps 2 --force --quiet"));
    let before =
        work.output(&format!("inspect equilibrium {SCENE} --design runs/pet-3x3/state.json"));
    std::fs::rename(work.path("runs/pet-3x3"), work.path("moved")).unwrap();
    std::fs::remove_dir_all(work.path("configs")).unwrap();
    std::fs::remove_file(work.path("data")).unwrap();
    work.write("before.json", before);
    work
}

#[test]
fn a_run_is_replayed_from_its_folder_alone() {
    let work = moved_run();
    let after = work.output("inspect equilibrium moved");
    // The design is named by its place, which is another one.
    let steps = |text: &str| -> serde_json::Value {
        serde_json::from_str::<serde_json::Value>(text).unwrap()["steps"].clone()
    };
    let before = work.read("before.json");
    assert!(
        steps(&before).is_array() && steps(&after) == steps(&before),
        "the same weights, material and loads give the same equilibria"
    );

    let listing: Value = serde_json::from_str(&after).unwrap();
    let steps = listing["steps"].as_array().unwrap();
    let corners: Vec<[[f64; 2]; 4]> =
        serde_json::from_value(steps[steps.len() - 1]["panel_corners"].clone()).unwrap();
    let mut points = "panel,corner,x,y\n".to_owned();
    for (panel, corners) in corners.iter().enumerate() {
        for (corner, [x, y]) in corners.iter().enumerate() {
            points += &format!("P{panel},{corner},{x},{y}\n");
        }
    }
    work.write("points.csv", points);
    let report = work.json("compare moved points.csv --json");
    let rms = report["full"]["corners"]["rms"].as_f64().unwrap();
    assert!(rms < 1e-6, "{report}");

    work.output("cut moved --force");
    let written = |name: &str| std::fs::read(work.path("moved").join(name)).unwrap();
    assert_eq!(written("cut/cut.dxf"), written("cut.dxf"));
    work.output("export moved --out exported");
    assert!(work.path("exported/sheet.pvd").exists());

    work.output("material check moved/inputs/material.toml moved");
    // The design of the run, unless the start design is asked for.
    let verify = "verify moved --equilibrium --rounds 1 --tier tiny --out verified";
    for (option, name) in [
        ("", "Equilibrium of the design moved/state.json "),
        (" --design start", "Equilibrium of the start design of moved "),
    ] {
        work.prints(&format!("{verify}{option}"), &[name]);
    }

    // The search continues there, too.
    work.output("design moved --steps 3 --force --quiet");
    let report: Value = serde_json::from_slice(&written("report.json")).unwrap();
    assert_eq!(report["steps"], 3, "{report}");
    work.output("cut moved --force");
}

#[test]
fn a_changed_copy_is_refused() {
    let work = moved_run();
    for name in
        ["scene.toml", "inputs/material.toml", "inputs/weights.json", "inputs/weights.safetensors"]
    {
        let path = work.path("moved").join(name);
        let original = std::fs::read(&path).unwrap();
        let mut changed = original.clone();
        let last = changed.len() - 1;
        changed[last] ^= 1;
        std::fs::write(&path, changed).unwrap();
        work.refuses("cut moved", &[name, "BLAKE3"]);
        std::fs::write(&path, original).unwrap();
    }
    work.output("cut moved --force");

    std::fs::create_dir(work.path("empty")).unwrap();
    work.refuses("cut empty", &["without the state of a run"]);
}
