//! `inspect springback`: residual opening of a sheet of polypropylene, in its thickness and in twice that, and laws that do not fit.

use crate::common::Workplace;
use serde_json::Value;
use std::path::Path;
use surrogate::Springback;

fn repository(path: &str) -> String {
    format!("{}/{path}", env!("CARGO_MANIFEST_DIR"))
}

/// The scene of four panels in the workplace, with some of its text replaced.
fn four_panels(work: &Workplace, name: &str, replacements: &[(&str, &str)]) {
    let scene = std::fs::read_to_string(repository("configs/sheets/four-panels-springback.toml"));
    let mut text = scene.unwrap().replace("../../", &repository(""));
    text = text.replace("../materials", &repository("configs/materials"));
    for (from, to) in replacements {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    std::fs::write(work.path(name), text).unwrap();
}

fn springback(scene: &str, options: &str) -> String {
    format!("inspect springback {scene} --design start {options}")
}

#[test]
fn a_plate_springs_back_and_one_of_twice_the_thickness_twice_as_far() {
    let work = Workplace::new();
    let (weights, named) = weights_with(&repository("data/polypropylene-3mm/springback.json"));
    four_panels(&work, "three.toml", &[(weights, &named)]);
    let doubled = [
        ("thickness = 3.0 ", "thickness = 6.0 "),
        ("[120.0, 120.0]", "[240.0, 240.0]"),
        ("[60.0, 60.0]", "[120.0, 120.0]"),
        ("start = 1.6", "start = 3.2"),
        ("[1.0, 2.8]", "[2.0, 5.6]"),
        ("kerf = 0.2", "kerf = 0.4"),
        ("r_win = 12.0", "r_win = 24.0"),
        ("stroke = 22.0", "stroke = 44.0"),
        (weights, &named),
    ];
    four_panels(&work, "six.toml", &doubled);
    let [three, six] = ["three.toml", "six.toml"].map(|scene| -> Value {
        let text = work.output(&springback(scene, "--json --picture released.svg"));
        serde_json::from_str(&text).unwrap()
    });
    let share = three["share"].as_f64().unwrap();
    assert!((0.5..0.8).contains(&share), "{share}");
    let number = |found: &Value, place: &str| found.pointer(place).unwrap().as_f64().unwrap();
    for (place, scale) in [
        ("/share", 1.0),
        ("/rotations/0/1", 1.0),
        ("/rest_rotations/3", 1.0),
        ("/displacement/0", 2.0),
        ("/displacement/1", 2.0),
        ("/corners/0", 2.0),
    ] {
        let (found, expected) = (number(&six, place), scale * number(&three, place));
        assert!(
            (found / expected - 1.0).abs() < 1e-6,
            "{place}: {found} {expected}"
        );
    }
    // Nothing pulls an unloaded sheet.
    let picture = std::fs::read_to_string(work.path("released.svg")).unwrap();
    assert!(
        picture.contains("</svg>") && !picture.contains(" N<"),
        "{picture}"
    );
    let text = work.output(&springback("three.toml", ""));
    assert!(text.contains("of the opening stays") && text.contains("Not in these numbers"));
}

/// Outside the training domain the law is not known, and no number is printed.
#[test]
fn what_stays_of_a_sheet_outside_the_domain_is_not_known() {
    let work = Workplace::new();
    let law = repository("data/polypropylene-3mm/springback.json");
    let (weights, named) = weights_with(&law);
    four_panels(
        &work,
        "far.toml",
        &[("stroke = 22.0", "stroke = 62.0"), (weights, &named)],
    );
    let outside = "4 hinges are outside the training domain at full load";
    let error = work.error(&springback("far.toml", ""));
    assert!(error.contains(outside), "{error}");
    let listed = work.output("design far.toml --steps 1 --force --out run");
    let mut rows = listed.lines();
    let row = rows.find(|line| line.starts_with(" springback "));
    let said = format!(" not known: {outside}");
    assert!(row.is_some_and(|row| row.contains(&said)), "{listed}");
}

/// The report of the design of a scene.
fn report(work: &Workplace, scene: &str) -> Value {
    serde_json::from_str(&work.output(&format!("design {scene} --json"))).unwrap()
}

fn weights_with(law: &str) -> (&'static str, String) {
    let weights = "data/polypropylene-3mm/medium.safetensors\"\n";
    (weights, format!("{weights}springback = \"{law}\"\n"))
}

#[test]
fn the_report_says_what_stays_by_the_law_that_the_scene_names() {
    let work = Workplace::new();
    let output = ("../../runs/springback/four-panels", "run");
    let output = (&*output.0.replace("../../", &repository("")), output.1);
    let (weights, named) = weights_with(&repository("data/polypropylene-3mm/springback.json"));
    four_panels(&work, "with.toml", &[output, (weights, &named)]);
    four_panels(&work, "without.toml", &[output]);
    let found = report(&work, "with.toml");
    let found = found.pointer("/facts/creep_and_springback").unwrap();
    // The run has a copy of the law.
    let listed = work.output("inspect springback run --json");
    let listed: Value = serde_json::from_str(&listed).unwrap();
    for key in ["rotations", "corners", "outline_error", "law"] {
        assert_eq!(found["released"][key], listed[key], "{key}");
    }
    assert!(listed["share"].as_f64().unwrap() < 0.9);
    assert_eq!(found["creep"]["ratio"], 3.0);
    let text = || std::fs::read_to_string(work.path("run/report.txt")).unwrap();
    let share = 100.0 * listed["share"].as_f64().unwrap();
    let stays = format!("stay when the load is taken off, {share:.0} %");
    assert!(text().contains(&stays), "{}", text());
    assert!(
        text().contains("falls to about 1/3 in 2 years"),
        "{}",
        text()
    );
    // The same run goes on without it.
    let without = report(&work, "without.toml");
    assert!(
        without
            .pointer("/facts/creep_and_springback/released")
            .unwrap()
            .is_null()
    );
    let unknown = "not known: the sheet springs back when the load is taken off";
    assert!(text().contains(unknown), "{}", text());
    assert!(
        work.error("inspect springback run")
            .contains("set surrogate.springback")
    );
}

#[test]
fn a_scene_with_a_law_for_another_sheet_is_refused() {
    let work = Workplace::new();
    let law = repository("data/polypropylene-3mm/springback.json");
    let mut other = Springback::load(Path::new(&law)).unwrap();
    other.material_hash = "0123456789abcdef".into();
    other.save(&work.path("other.json")).unwrap();
    let film = repository("data/pet-0.5mm/medium.json");
    for (law, expected) in [
        (&*film, "is not a law of released hinges"),
        ("nowhere.json", "cannot read nowhere.json"),
        ("other.json", "the sheet is of another material law"),
    ] {
        let (weights, named) = weights_with(law);
        four_panels(&work, "scene.toml", &[(weights, &named)]);
        let error = work.error("design scene.toml");
        let error = error.split_whitespace().collect::<Vec<_>>().join(" ");
        let named = error.contains("surrogate.springback: ");
        assert!(named && error.contains(expected), "{error}");
    }
}

#[test]
fn weights_that_are_not_for_the_sheet_are_refused() {
    let work = Workplace::new();
    let error = work.error(&springback("configs/scenes/linear-7x7.toml", ""));
    assert!(error.contains("set surrogate.springback"), "{error}");
    let film = "configs/materials/polypropylene-3mm.toml";
    let weights = repository("data/pet-0.5mm/medium.safetensors");
    let error = work.error(&format!("surrogate release {weights} --material {film}"));
    assert!(error.contains("another material law"), "{error}");
    let error = work.error(&format!(
        "surrogate release {weights} --material configs/materials/pet-0.5mm.toml --count 40"
    ));
    assert!(error.contains("--count 40 leaves 10 hinges"), "{error}");
}

/// The search moves the sheet without loads to its target, and everything that it writes is of that state.
#[test]
fn a_design_for_the_shape_that_stays() {
    let work = Workplace::new();
    let law = repository("data/polypropylene-3mm/springback.json");
    let output = repository("runs/springback/four-panels");
    let (weights, named) = weights_with(&law);
    let released = [
        (&*output, "run"),
        (weights, &named),
        (
            "size = [120.0, 120.0]\nrotation",
            "size = [140.0, 135.0]\nrotation",
        ),
        (
            "[optimiser]",
            "[objective]\ntarget_state = \"released\"\n\n[optimiser]",
        ),
        ("steps = 1\n", "steps = 6\n"),
    ];
    four_panels(&work, "scene.toml", &released);
    let found = report(&work, "scene.toml");
    let number = |place: &str| found.pointer(place).unwrap().as_f64().unwrap();
    assert_eq!(found["facts"]["target_state"], "released");
    let (before, after) = (
        number("/before/outline_error"),
        number("/after/outline_error"),
    );
    assert!(after < 0.9 * before, "{before} {after}");
    let [loaded, free] = [0, 1].map(|i| {
        number(&format!(
            "/facts/creep_and_springback/released/outline_error/{i}"
        ))
    });
    assert!((free / after - 1.0).abs() < 1e-9, "{free} {after}");
    assert!((loaded / free - 1.0).abs() > 0.1, "{loaded} {free}");
    for (file, text) in [
        ("deployed.svg", "Loads taken off"),
        (
            "report.txt",
            "after the loads were taken off; the target is for that state",
        ),
        ("run.html", "\"unloaded\":true"),
    ] {
        let written = std::fs::read_to_string(work.path("run").join(file)).unwrap();
        assert!(written.contains(text), "{file}");
    }
    // Another law has other sheets: the run does not continue with it.
    let mut other = Springback::load(Path::new(&law)).unwrap();
    other.tier = "plate-tiny".into();
    other.save(&work.path("other.json")).unwrap();
    let (_, named) = weights_with("other.json");
    let changed = released.map(|(from, to)| (from, if from == weights { &*named } else { to }));
    four_panels(&work, "scene.toml", &changed);
    let error = work.error("design scene.toml");
    assert!(error.contains("the law of released hinges"), "{error}");
    let unnamed = released.map(|(from, to)| (from, if from == weights { weights } else { to }));
    four_panels(&work, "scene.toml", &unnamed);
    let error = work.error("design scene.toml");
    assert!(
        error.contains("objective.target_state") && error.contains("surrogate.springback"),
        "{error}"
    );
}
