//! Levels: `--level`, `--within`, `kirigami levels`.

use crate::common::Workplace;
use serde_json::Value;

/// The shipped plate, with its weights.
const PLATE: &str = "configs/scenes/a4-plate.toml";

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn a_design_within_an_accuracy_is_searched_on_the_cheapest_level_that_has_it() {
    let work = Workplace::new();
    let design = format!("design {PLATE} --within 0.5mm --out plate --json --quiet");
    let report = json(&work.output(&design));
    let [search] = &report["coarse_searches"].as_array().unwrap()[..] else {
        panic!("{}", report["coarse_searches"]);
    };
    let mut facts = report["facts"].as_array().unwrap().iter();
    let level = &facts.find(|fact| fact["label"] == "level").unwrap()["value"];
    assert_eq!([&search["level"], &search["finer"], level], ["draft", "standard", "standard"]);
    let largest = search["difference"]["corners"][1].as_f64().unwrap();
    assert!(largest > 0.0 && largest < 0.5, "{largest}");
    let loss = |scores: &Value| scores["loss"].as_f64().unwrap();
    assert!(loss(&report["after"]) < 0.95 * loss(&report["before"]));
    let text = work.read("plate/report.txt");
    assert!(text.lines().next().unwrap().ends_with("level standard"), "{text}");
    assert!(text.contains("tolerance: 0.5 mm"), "{text}");
    // The outline error rises while the loss falls, and the report says by which parts.
    assert!(text.contains("637.6 at the start, 565.4 mm^2"), "{text}");
    assert!(text.contains("The outline error rose while the loss fell"), "{text}");
    // The same command, and the run folder alone, are the same run.
    for again in [&*design, "design plate --json --quiet"] {
        let again = json(&work.output(again));
        assert_eq!(again["after"], report["after"]);
        assert_eq!(again["coarse_searches"], report["coarse_searches"]);
    }
}

/// Below what the mesh of the windows is known to, more expensive levels are not tried.
#[test]
fn an_accuracy_that_no_level_has_is_said() {
    let work = Workplace::new();
    work.prints(
        &format!("design {PLATE} --out plate --quiet --within 0.001mm"),
        &["less than the mesh of the windows"],
    );
}

#[test]
fn levels_are_compared_at_one_design() {
    let work = Workplace::new();
    let levels = format!("levels {PLATE} --design start --quiet");
    let found = json(&work.output(&format!("{levels} --json")));
    let names: Vec<_> = (found["levels"].as_array().unwrap().iter())
        .map(|level| level["level"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["pin", "linear", "draft", "standard", "fine"]);
    work.prints(&levels, &["no level lowers: window mesh"]);
    let draft = work.json(&format!("inspect equilibrium {PLATE} --design start --level draft"));
    // The weight comes on at negative load factors.
    let loaded = draft["steps"].as_array().unwrap().iter().filter(|step| {
        step["status"] == "converged" && step["load_factor"].as_f64().unwrap() >= 0.0
    });
    assert_eq!(loaded.count(), 5, "{draft}");
}

/// What is measured of a run is in its report and on its page, until its design changes.
#[test]
fn the_levels_of_a_run_are_in_its_report() {
    let work = Workplace::new();
    work.output(&format!("design {PLATE} --out plate --steps 1 --quiet"));
    let report = |work: &Workplace| json(&work.read("plate/report.json"));
    assert!(report(&work)["checks"]["levels"].is_null());
    let cut = std::fs::read(work.path("plate/cut.dxf")).unwrap();
    let measured = json(&work.output("levels plate --json --quiet"));
    let found = report(&work);
    assert_eq!(found["checks"]["levels"]["levels"], measured["levels"]);
    assert_eq!(std::fs::read(work.path("plate/cut.dxf")).unwrap(), cut);
    let text = work.read("plate/report.txt");
    let row = text.lines().find(|line| line.starts_with(" levels "));
    assert!(row.is_some_and(|row| row.contains("to `fine`")), "{text}");
    let page = work.read("plate/run.html");
    assert!(page.contains("\"search\":"), "no levels on the page");
    work.output(&format!("design {PLATE} --out plate --steps 2 --quiet"));
    assert!(report(&work)["checks"]["levels"].is_null());
}
