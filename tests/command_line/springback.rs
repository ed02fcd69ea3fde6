//! Residual opening of a sheet of polypropylene, in its thickness and in twice that, and laws that
//! do not fit.

use crate::common::Workplace;
use serde_json::Value;
use surrogate::Springback;

/// The law of released hinges of the shipped plate.
const LAW: &str = "data/polypropylene-3mm/springback.json";
/// Weights in the scene of four panels.
const WEIGHTS: &str = "data/polypropylene-3mm/medium.safetensors\"\n";

/// Copies the scene of four panels, with some of its text replaced.
fn four_panels(work: &Workplace, name: &str, replacements: &[(&str, &str)]) {
    let shipped = work.path("configs/sheets/four-panels-springback.toml");
    std::fs::copy(shipped, work.path(name)).unwrap();
    let paths = [("\"../../", "\""), ("\"../materials", "\"configs/materials")];
    work.edit(name, &[&paths, replacements].concat());
}

/// The weights with a law of released hinges.
fn with_law(law: &str) -> String {
    format!("{WEIGHTS}springback = \"{law}\"\n")
}

#[test]
fn a_plate_springs_back_and_one_of_twice_the_thickness_twice_as_far() {
    let work = Workplace::new();
    four_panels(&work, "three.toml", &[(WEIGHTS, &with_law(LAW))]);
    let doubled = [
        ("thickness = 3.0 ", "thickness = 6.0 "),
        ("[120.0, 120.0]", "[240.0, 240.0]"),
        ("[60.0, 60.0]", "[120.0, 120.0]"),
        ("start = 1.6", "start = 3.2"),
        ("[1.0, 2.8]", "[2.0, 5.6]"),
        ("slit_width = 0.2", "slit_width = 0.4"),
        ("r_win = 12.0", "r_win = 24.0"),
        ("stroke = 22.0", "stroke = 44.0"),
        (WEIGHTS, &with_law(LAW)),
    ];
    four_panels(&work, "six.toml", &doubled);
    let [three, six] = ["three", "six"].map(|name| {
        let report = report(&work, &format!("{name}.toml --steps 0 --force --out {name}"));
        released(&report).clone()
    });
    let share = share(&three);
    assert!((0.5..0.8).contains(&share), "{share}");
    let number = |found: &Value, place: &str| found.pointer(place).unwrap().as_f64().unwrap();
    for (place, scale) in [
        ("/rotations/0/1", 1.0),
        ("/rest_rotations/3", 1.0),
        ("/displacement/0", 2.0),
        ("/displacement/1", 2.0),
        ("/corners/0", 2.0),
    ] {
        let (found, expected) = (number(&six, place), scale * number(&three, place));
        assert!((found / expected - 1.0).abs() < 1e-6, "{place}: {found} {expected}");
    }
}

/// Outside the training domain the law is not known, and no number is printed.
#[test]
fn what_stays_of_a_sheet_outside_the_domain_is_not_known() {
    let work = Workplace::new();
    let further = ("stroke = 22.0", "stroke = 62.0");
    four_panels(&work, "far.toml", &[further, (WEIGHTS, &with_law(LAW))]);
    let outside = "4 hinges are outside the training domain at full load";
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

/// The unloaded sheet of a report.
fn released(report: &Value) -> &Value {
    let place = "/facts/creep_and_springback/released";
    report.pointer(place).unwrap()
}

/// The mean rotation of its hinges over the mean rotation under load.
fn share(released: &Value) -> f64 {
    let hinges: Vec<[f64; 2]> = serde_json::from_value(released["rotations"].clone()).unwrap();
    let [loaded, free] = [0, 1].map(|i| hinges.iter().map(|it| it[i].abs()).sum::<f64>());
    free / loaded
}

#[test]
fn the_report_says_what_stays_by_the_law_that_the_scene_names() {
    let work = Workplace::new();
    let output = ("runs/springback/four-panels", "run");
    four_panels(&work, "with.toml", &[output, (WEIGHTS, &with_law(LAW))]);
    four_panels(&work, "without.toml", &[output]);
    let found = report(&work, "with.toml");
    // The run has a copy of the law.
    assert_eq!(released(&report(&work, "run")), released(&found));
    let creep = "/facts/creep_and_springback/creep/ratio";
    assert_eq!(found.pointer(creep).unwrap(), 3.0);
    let text = || std::fs::read_to_string(work.path("run/report.txt")).unwrap();
    let share = 100.0 * share(released(&found));
    assert!(share < 90.0, "{share}");
    let stays = format!("stay when the load is taken off, {share:.0} %");
    assert!(text().contains(&stays), "{}", text());
    assert!(text().contains("falls to about 1/3 in 2 years"), "{}", text());
    // The same run goes on without it.
    let without = report(&work, "without.toml");
    assert!(released(&without).is_null());
    let unknown = "not known: the sheet springs back when the load is taken off";
    assert!(text().contains(unknown), "{}", text());
}

#[test]
fn a_scene_with_a_law_for_another_sheet_is_refused() {
    let work = Workplace::new();
    let mut other = Springback::load(&work.path(LAW)).unwrap();
    other.material_hash = "0123456789abcdef".into();
    other.save(&work.path("other.json")).unwrap();
    four_panels(&work, "scene.toml", &[(WEIGHTS, &with_law("other.json"))]);
    let error = work.error("design scene.toml");
    assert!(error.contains("the sheet is of another material law"), "{error}");
}

/// The search moves the sheet without loads to its target, and everything that it writes is of that
/// state.
#[test]
fn a_design_for_the_shape_that_stays() {
    let work = Workplace::new();
    let law = with_law(LAW);
    let released = [
        ("runs/springback/four-panels", "run"),
        (WEIGHTS, &*law),
        ("size = [120.0, 120.0]\nrotation", "size = [140.0, 135.0]\nrotation"),
        ("[optimiser]", "[objective]\ntarget_state = \"released\"\n\n[optimiser]"),
        ("steps = 1\n", "steps = 6\n"),
    ];
    four_panels(&work, "scene.toml", &released);
    let found = report(&work, "scene.toml");
    let number = |place: &str| found.pointer(place).unwrap().as_f64().unwrap();
    assert_eq!(found["facts"]["target_state"], "released");
    let (before, after) = (number("/before/outline_error"), number("/after/outline_error"));
    assert!(after < 0.9 * before, "{before} {after}");
    let [loaded, free] =
        [0, 1].map(|i| number(&format!("/facts/creep_and_springback/released/outline_error/{i}")));
    assert!((free / after - 1.0).abs() < 1e-9, "{free} {after}");
    assert!((loaded / free - 1.0).abs() > 0.1, "{loaded} {free}");
    for (file, text) in [
        ("deployed.svg", "Loads taken off"),
        ("report.txt", "after the loads were taken off; the target is for that state"),
        ("run.html", "\"unloaded\":true"),
    ] {
        let written = std::fs::read_to_string(work.path("run").join(file)).unwrap();
        assert!(written.contains(text), "{file}");
    }
    // Another law has other sheets: the run does not continue with it.
    let mut other = Springback::load(&work.path(LAW)).unwrap();
    other.tier = "plate-tiny".into();
    other.save(&work.path("other.json")).unwrap();
    let renamed = |law| released.map(|(from, to)| (from, if from == WEIGHTS { law } else { to }));
    let other = with_law("other.json");
    four_panels(&work, "scene.toml", &renamed(&*other));
    let error = work.error("design scene.toml");
    assert!(error.contains("the law of released hinges"), "{error}");
    four_panels(&work, "scene.toml", &renamed(WEIGHTS));
    let error = work.error("design scene.toml");
    assert!(
        error.contains("objective.target_state") && error.contains("surrogate.springback"),
        "{error}"
    );
}
