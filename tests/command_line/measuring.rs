//! `compare` and `export` on a designed sheet: from the template to the report, and the files of
//! other programs.

use crate::common::Workplace;
use app::chosen::Chosen;
use serde_json::Value;
use std::path::Path;

const SCENE: &str = "configs/scenes/linear-7x7.toml";

/// A sheet after two search steps, and its deployed corners at the load steps.
fn designed() -> (Workplace, Vec<Vec<[[f64; 2]; 4]>>) {
    let work = Workplace::new();
    work.output(&format!("design {SCENE} --steps 2 --quiet"));
    let listing =
        work.output(&format!("inspect equilibrium {SCENE} --design runs/linear-7x7/state.json"));
    let listing: Value = serde_json::from_str(&listing).unwrap();
    let steps = listing["steps"].as_array().unwrap();
    let corners =
        steps.iter().map(|step| serde_json::from_value(step["panel_corners"].clone()).unwrap());
    (work, corners.collect())
}

/// Writes the corners, turned by a quarter turn and shifted, in cm.
fn measure(work: &Workplace, name: &str, corners: &[[[f64; 2]; 4]]) {
    let mut text = "panel,corner,x,y,unit\n".to_owned();
    for (panel, corners) in corners.iter().enumerate() {
        for (corner, [x, y]) in corners.iter().enumerate() {
            text += &format!("P{panel},{corner},{},{},cm\n", 100.0 - y / 10.0, x / 10.0);
        }
    }
    text += "# measured with a ruler";
    work.write(name, text);
}

fn compared(work: &Workplace, options: &str) -> Value {
    work.json(&format!("compare {SCENE} --json {options}"))
}

#[test]
fn a_measured_sheet_is_compared_with_its_path() {
    let (work, steps) = designed();
    // Without a design, the design of the scene's run folder is meant.
    work.output(&format!("compare {SCENE} --template --out template"));
    let template = work.read("template/template.csv");
    assert_eq!(template.lines().count(), 1 + 5 * 49);
    assert!(work.path("template/numbering.png").exists());
    assert!(work.error(&format!("compare {SCENE} --template --out template")).contains("exists"));

    // The sixth of ten load steps.
    measure(&work, "points.csv", &steps[5]);
    let report = compared(&work, "points.csv --out report");
    let number = |value: &Value| value.as_f64().unwrap();
    assert!((number(&report["best"]["load_factor"]) - 0.6).abs() < 1e-6);
    assert!(number(&report["best"]["corners"]["rms"]) < 1e-3);
    assert!(number(&report["full"]["corners"]["rms"]) > 1.0);
    assert!((number(&report["motion"]["rotation_deg"]) - 90.0).abs() < 1e-4);
    assert_eq!(report["openings"].as_array().unwrap().len(), 84);
    for name in ["comparison.txt", "comparison.json", "comparison.svg", "comparison.png"] {
        assert!(work.path("report").join(name).exists(), "{name}");
    }
    let rows = |name: &str| {
        std::fs::read_to_string(work.path("report").join(name)).unwrap().lines().count() - 1
    };
    assert_eq!((rows("residuals.csv"), rows("openings.csv")), (4 * 49, 84));

    // The sheet before deployment, in the same frame: nothing slipped.
    let (scene, state) = (work.path(SCENE), work.path("runs/linear-7x7/state.json"));
    let (scene, design, _) = Chosen { scene: &scene, design: Some(&state) }.read().unwrap();
    let (_, sheet) = scene.problem().unwrap().cut(&design).unwrap();
    let flat: Vec<_> = sheet.panels.iter().map(|panel| panel.corners).collect();
    measure(&work, "closed.csv", &flat);
    let report = compared(&work, "points.csv --closed closed.csv --out report");
    let slip = &report["closed"]["slips"][0];
    assert_eq!(slip["panel"], 24);
    assert!(slip["slip"].as_array().unwrap().iter().all(|x| number(x).abs() < 1e-2), "{slip}");
}

/// The spreadsheets of countries with a decimal comma.
#[test]
fn semicolons_and_decimal_commas_are_read() {
    let (work, steps) = designed();
    measure(&work, "points.csv", &steps[9]);
    let points = work.read("points.csv");
    let german = points.replace(',', ";").replace('.', ",");
    work.write("german.csv", german);
    let [usual, german] = ["points.csv", "german.csv"].map(|file| compared(&work, file));
    assert_eq!(usual["openings"].as_array().unwrap().len(), 84);
    assert_eq!(usual["openings"], german["openings"]);
}

fn parsed(path: &Path, check: impl FnOnce(&roxmltree::Document)) {
    let text = std::fs::read_to_string(path).unwrap();
    check(&roxmltree::Document::parse(&text).unwrap());
}

#[test]
fn a_deployment_is_exported_state_by_state() {
    let (work, steps) = designed();
    work.prints(&format!("export {SCENE} --out export"), &["11 states"]);
    parsed(&work.path("export/sheet.pvd"), |series| {
        let sets: Vec<_> =
            series.descendants().filter(|node| node.has_tag_name("DataSet")).collect();
        assert_eq!(sets.len(), 2 * (1 + steps.len()));
        for set in &sets {
            assert!(work.path("export").join(set.attribute("file").unwrap()).exists());
        }
        assert_eq!(sets[2].attribute("timestep"), Some("0.1"));
    });
    for (name, points, cells, field) in [
        ("panels-010.vtu", "196", "49", "rotation (deg)"),
        ("hinges-010.vtu", "84", "84", "W (N mm)"),
    ] {
        parsed(&work.path("export/vtk").join(name), |grid| {
            let piece = grid.descendants().find(|node| node.has_tag_name("Piece")).unwrap();
            assert_eq!(piece.attribute("NumberOfPoints"), Some(points));
            assert_eq!(piece.attribute("NumberOfCells"), Some(cells));
            assert!(grid.descendants().any(|node| node.attribute("Name") == Some(field)));
        });
    }
}
