//! `calibrate coupon`: from a scene to the test pieces of its plate, and from their readings to the scene of that plate.

mod common;

use common::Workplace;
use serde_json::Value;
use std::fmt::Write;
use std::path::Path;

/// The shipped plate, with its weights, and its coupon in `coupon`; the coupon's JSON.
fn coupon(work: &Workplace) -> Value {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).display().to_string();
    let data = format!("{root}/data");
    work.edit("configs/scenes/a4-plate.toml", &[("../../data", &data)]);
    let written = work.output("calibrate coupon configs/scenes/a4-plate.toml --out coupon --json");
    serde_json::from_str(&written).unwrap()
}

/// Readings of specimens that open further than drawn by a factor.
fn readings(coupon: &Value, factor: impl Fn(&str) -> f64) -> String {
    let mut text = "specimen,mass_g,distance_mm\n".to_owned();
    for of in coupon.as_array().unwrap() {
        let name = of["name"].as_str().unwrap();
        let numbers = |key: &str| -> Vec<f64> { serde_json::from_value(of[key].clone()).unwrap() };
        let distance = of["distance_mm"].as_f64().unwrap();
        writeln!(text, "{name},0,{distance}").unwrap();
        for (mass, moved) in std::iter::zip(numbers("masses_g"), numbers("displacements_mm")) {
            writeln!(text, "{name},{mass},{}", distance + factor(name) * moved).unwrap();
        }
    }
    text
}

fn calibrated(work: &Workplace, readings: &str, options: &str) -> Value {
    std::fs::write(work.path("coupon/readings.csv"), readings).unwrap();
    let report = work.output(&format!("calibrate coupon/ {options} --json"));
    serde_json::from_str(&report).unwrap()
}

#[test]
fn a_coupon_is_cut_read_and_calibrated() {
    let work = Workplace::new();
    let coupon = coupon(&work);
    assert_eq!(coupon.as_array().unwrap().len(), 6);
    let page = std::fs::read_to_string(work.path("coupon/coupon.md")).unwrap();
    let cut = std::fs::read_to_string(work.path("coupon/cut.svg")).unwrap();
    for of in coupon.as_array().unwrap() {
        let name = of["name"].as_str().unwrap();
        assert!(page.contains(&format!("| {name} |")), "{page}");
        assert!(cut.contains(&format!(">{name}<")));
        let masses: Vec<f64> = serde_json::from_value(of["masses_g"].clone()).unwrap();
        assert!(masses.len() >= 3 && masses.is_sorted(), "{masses:?}");
    }
    let readings = readings(&coupon, |_| 1.0);
    let found = calibrated(&work, &readings, "--known thickness=3.0 --out found");
    let [kerf, stress] = ["kerf", "stress"].map(|key| found[key].as_f64().unwrap());
    assert!(
        (kerf - 0.2).abs() < 1e-3 && (stress - 1.0).abs() < 1e-3,
        "{kerf} {stress}"
    );
    // A thinner plate that opens as far is stronger.
    for (wrong, said) in [
        ("thickness=0.293", "decimal point"),
        ("kerf=0.2,kerf=0.3", "names kerf twice"),
    ] {
        let error = work.error(&format!("calibrate coupon/ --known {wrong} --out none"));
        assert!(error.contains(said), "{error}");
    }
    let thin = calibrated(
        &work,
        &readings,
        "--known thickness=2.9,kerf=0.2 --out thin",
    );
    let stress = thin["stress"].as_f64().unwrap();
    assert!((stress - 3.0 / 2.9).abs() < 0.02, "{stress}");
    let scene = std::fs::read_to_string(work.path("thin/scene.toml")).unwrap();
    assert!(
        scene.contains("thickness = 2.9\n") && scene.contains("2.9000, known"),
        "{scene}"
    );
    let material = std::fs::read_to_string(work.path("thin/sheet/material.toml")).unwrap();
    assert!(material.contains("coupon"), "{material}");
    work.output("inspect equilibrium thin/scene.toml --design start");
    // A coupon with readings is not replaced.
    let again = "calibrate coupon configs/scenes/a4-plate.toml --out coupon";
    let error = work.error(again);
    assert!(error.contains("holds readings"), "{error}");
    work.output(&format!("{again} --force --for laser-service"));
    let cut = std::fs::read_to_string(work.path("coupon/cut.svg")).unwrap();
    assert!(!cut.contains("<text"));
}

#[test]
fn wrong_readings_of_a_coupon_are_refused() {
    let work = Workplace::new();
    let coupon = coupon(&work);
    let refused = |text: &str, expected: &[&str]| {
        std::fs::write(work.path("coupon/readings.csv"), text).unwrap();
        let error = work.error("calibrate coupon/ --fit stress");
        for part in expected {
            assert!(error.contains(part), "{error}");
        }
    };
    let empty = std::fs::read_to_string(work.path("coupon/readings.csv")).unwrap();
    refused(&empty, &["readings.csv has no readings"]);
    refused("specimen,mass_g,distance_mm\n", &["has no readings"]);
    refused(
        "mass_g,distance_mm\n0,80\n",
        &["no column `specimen`", "A1"],
    );
    refused(
        "specimen,mass_g,distance_mm\nA4,0,80\n",
        &["readings.csv:2", "no specimen `A4`", "use A1, A2"],
    );
    refused(
        "specimen,mass_g,distance_mm\nA1,80,0\nA1,83,300\n",
        &["readings.csv:2", "seem to be swapped"],
    );
    refused(
        "specimen,mass_g,distance_mm\nA1,0,80\n",
        &["readings.csv:2", "alone"],
    );
    let first = &coupon[0]["masses_g"][0];
    refused(
        &format!("specimen,mass_g,distance_mm\nA1,0,80\nA1,{first},180\n"),
        &["specimen A1", "readings.csv:3", "check the units"],
    );
    refused(
        "specimen,mass_g,distance_mm\nA1,0,80\nA1,900000,81\n",
        &["specimen A1", "readings.csv:3", "at most that at full load"],
    );
    let error = work.error("calibrate coupon/ --points points.csv");
    assert!(error.contains("leave out --points"), "{error}");
    let error = work.error(
        "calibrate configs/scenes/a4-plate.toml --design start --readings coupon/readings.csv",
    );
    assert!(error.contains("folder of the coupon"), "{error}");
    work.edit(
        "configs/scenes/a4-plate.toml",
        &[("kerf = 0.2", "kerf = 0.25")],
    );
    std::fs::write(work.path("coupon/readings.csv"), readings(&coupon, |_| 1.0)).unwrap();
    let error = work.error("calibrate coupon/");
    assert!(error.contains("have changed"), "{error}");
}

/// One specimen was opened before: the fit says that it contradicts the others, and widens the errors.
#[test]
fn readings_that_contradict_each_other_are_named() {
    let work = Workplace::new();
    let coupon = coupon(&work);
    let right = readings(&coupon, |_| 1.0);
    let wrong = readings(&coupon, |name| if name == "A1" { 1.6 } else { 1.0 });
    let error = |readings: &str| {
        let found = calibrated(&work, readings, "--fit stress");
        found["calibration"]["estimates"][0]["standard_error"]
            .as_f64()
            .unwrap()
    };
    let [right, wrong] = [right, wrong].map(|readings| error(&readings));
    assert!(wrong > 2.0 * right, "{right} {wrong}");
    let page = std::fs::read_to_string(work.path("runs/calibrate/calibration.txt")).unwrap();
    assert!(
        page.contains("contradict") && page.contains("specimen A1"),
        "{page}"
    );
}

#[test]
fn a_film_has_no_coupon() {
    let work = Workplace::new();
    let data = format!("{}/data", env!("CARGO_MANIFEST_DIR"));
    work.edit("configs/scenes/pet-3x3.toml", &[("../../data", &data)]);
    let error = work.error("calibrate coupon configs/scenes/pet-3x3.toml");
    assert!(error.contains("those of a film"), "{error}");
    let error = work.error("calibrate coupon configs/scenes/linear-7x7.toml");
    assert!(error.contains("learned hinge law"), "{error}");
}
