//! `calibrate` on a sheet that is thinner than its drawing says: from the tables to the scene of that sheet.

mod common;

use common::Workplace;
use serde_json::Value;
use std::fmt::Write;
use std::path::Path;

/// The scene of nine panels under dead loads in the thickness (mm); it names the shipped weights.
fn scene(work: &Workplace, name: &str, thickness: f64) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("configs/scenes/pet-3x3.toml")).unwrap();
    let root = root.display();
    let text = text
        .replace("../../data", &format!("{root}/data"))
        .replace("../materials", &format!("{root}/configs/materials"))
        .replace("../../runs/pet-3x3", "run")
        .replace("r_win = 100.0", &format!("r_win = {}", 200.0 * thickness))
        .replace("hinge = ", &format!("thickness = {thickness}\nhinge = "));
    std::fs::write(work.path(name), text).unwrap();
}

/// The equilibria of the start design of a scene.
fn equilibria(work: &Workplace, scene: &str) -> Value {
    let text = work.output(&format!(
        "inspect equilibrium {scene} --design start --json"
    ));
    serde_json::from_str(&text).unwrap()
}

fn corners(equilibria: &Value) -> Vec<[[f64; 2]; 4]> {
    let steps = equilibria["steps"].as_array().unwrap();
    let last = steps.last().unwrap()["panel_corners"].clone();
    serde_json::from_value(last).unwrap()
}

#[test]
fn a_thinner_sheet_is_found_and_its_scene_predicts_it() {
    let work = Workplace::new();
    scene(&work, "drawing.toml", 0.5);
    scene(&work, "thin.toml", 0.49);
    let thin = corners(&equilibria(&work, "thin.toml"));
    let mut text = "panel,corner,x,y\n".to_owned();
    for (panel, corners) in thin.iter().enumerate() {
        for (corner, [x, y]) in corners.iter().enumerate() {
            writeln!(text, "{panel},{corner},{:.3},{:.3}", 500.0 - y, x).unwrap();
        }
    }
    std::fs::write(work.path("points.csv"), text).unwrap();
    let calibrate = "calibrate drawing.toml --design start --points points.csv --point-error 0.05";
    let report = work.output(&format!("{calibrate} --fit thickness --out found --json"));
    let report: Value = serde_json::from_str(&report).unwrap();
    let thickness = report["thickness"].as_f64().unwrap();
    assert!((thickness - 0.49).abs() < 1e-4, "{thickness}");
    assert_eq!(
        (&report["kerf"], &report["stress"]),
        (&0.2.into(), &1.0.into())
    );
    let page = std::fs::read_to_string(work.path("found/calibration.txt")).unwrap();
    assert!(
        page.contains("as in the scene") && page.contains("0.4900 +-"),
        "{page}"
    );
    // The scene that was written is that of the thin sheet.
    let found = corners(&equilibria(&work, "found/scene.toml"));
    let pairs = std::iter::zip(found.as_flattened(), thin.as_flattened());
    let farthest = pairs
        .map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]))
        .fold(0.0, f64::max);
    assert!(farthest < 0.1, "{farthest}");
}

#[test]
fn wrong_tables_are_refused_with_their_line() {
    let work = Workplace::new();
    scene(&work, "drawing.toml", 0.5);
    let refused = |text: &str, expected: &[&str]| {
        std::fs::write(work.path("readings.csv"), text).unwrap();
        let error = work.error("calibrate drawing.toml --design start --readings readings.csv");
        for part in expected {
            assert!(error.contains(part), "{error}");
        }
    };
    refused(
        "displacement,load_N\n1,2\n",
        &["0 columns of the displacement", "displacement_mm"],
    );
    refused(
        "displacement_mm,load_N\n40,x\n",
        &["readings.csv:2", "`load_N`", "not a number"],
    );
    refused("displacement_mm,load_N\n", &["no readings"]);
    refused(
        "displacement_mm,load_Nmm\n40,9\n",
        &["displacement_deg with load_Nmm"],
    );
    refused(
        "displacement_deg,load_Nmm\n40,9\n",
        &["readings.csv", "moved by forces"],
    );
    refused(
        "displacement_mm,load_N,mass_g\n40,9,900\n",
        &["2 columns of the load"],
    );
    refused(
        "displacement_mm,load_N\n0,0\n",
        &["readings.csv:2", "before its loads"],
    );
    refused(
        "displacement_mm,mass_g\n40,99000\n",
        &["readings.csv:2", "a load of 971.19"],
    );
    refused(
        "displacement_mm,load_N\n40,9\n50,8\n",
        &["readings.csv:3", "ascending"],
    );
}

/// A softer sheet than there can be: the search ends with a message.
#[test]
fn a_reading_that_no_sheet_has_is_no_panic() {
    let work = Workplace::new();
    scene(&work, "drawing.toml", 0.5);
    std::fs::write(work.path("readings.csv"), "displacement_mm,load_N\n250,7\n").unwrap();
    for quantity in ["stress", "thickness", "kerf"] {
        let calibrate = "calibrate drawing.toml --design start --readings readings.csv";
        let output = (work
            .program(&format!("{calibrate} --fit {quantity}"))
            .output())
        .unwrap();
        let code = output.status.code();
        assert!(code == Some(0) || code == Some(1), "{quantity}: {code:?}");
    }
}

#[test]
fn a_scene_or_a_run_is_not_replaced() {
    let work = Workplace::new();
    std::fs::create_dir(work.path("own")).unwrap();
    scene(&work, "own/scene.toml", 0.5);
    std::fs::write(work.path("readings.csv"), "displacement_mm,load_N\n40,9\n").unwrap();
    let error = work.error(
        "calibrate own/scene.toml --design start --readings readings.csv --fit stress --out own",
    );
    assert!(error.contains("no calibration has written"), "{error}");
}
