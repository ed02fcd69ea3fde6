//! The page of a run: self-contained, and equal to the report.

use super::learned::{learned, weights};
use super::{read, run, with};
use base64::Engine;
use output::report::Report;
use output::run_results::write_results;
use serde_json::Value;
use std::path::Path;

/// The page and the report of a scene.
fn page(folder: &Path, scene: &str) -> (String, Report) {
    let scene = read(folder, scene);
    let designed = run(&scene, None).unwrap();
    let report = write_results(&scene, &designed, false).unwrap();
    let page = std::fs::read_to_string(scene.output().join("run.html")).unwrap();
    (page, report)
}

/// The data of a page.
fn data(page: &str) -> Value {
    let (_, data) = page.split_once("id=\"run\">").unwrap();
    let (data, _) = data.split_once("</script>").unwrap();
    serde_json::from_str(data).unwrap()
}

fn floats(packed: &Value) -> Vec<f32> {
    let bytes = base64::engine::general_purpose::STANDARD.decode(packed.as_str().unwrap());
    let bytes = bytes.unwrap();
    let (numbers, rest) = bytes.as_chunks::<4>();
    assert!(rest.is_empty());
    numbers
        .iter()
        .map(|bytes| f32::from_le_bytes(*bytes))
        .collect()
}

fn assert_close(found: f32, expected: f64, place: &str) {
    let error = (f64::from(found) - expected).abs();
    // Half a unit in the last place of a 32-bit float, and its smallest normal number.
    assert!(
        error <= 1e-7 * expected.abs() + 1e-37,
        "{place}: {found} {expected}"
    );
}

/// Asserts that the numbers of all hinges in the last state are those of the report.
fn assert_equals_report(data: &Value, report: &Report) {
    let (count, states) = (report.hinges.len(), &data["states"]);
    let deformations = floats(&states["deformations"]);
    let last = &deformations[deformations.len() - 3 * count..];
    let [w_lig, alpha, gamma] =
        ["w_lig", "alpha_deg", "gamma"].map(|name| floats(&data["hinges"][name]));
    for row in &report.hinges {
        let h = row.hinge;
        assert_close(last[3 * h], row.eta_a * row.w_lig, "a");
        assert_close(last[3 * h + 1], row.eta_s * row.w_lig, "s");
        assert_close(last[3 * h + 2], row.theta_deg.to_radians(), "theta");
        assert_close(w_lig[h], row.w_lig, "w_lig");
        assert_close(alpha[h], row.alpha_deg, "alpha");
        assert_eq!(gamma[h].is_nan(), row.gamma.is_none(), "Gamma");
        if let Some(expected) = row.gamma {
            assert_close(gamma[h], expected, "Gamma");
        }
    }
}

#[test]
fn the_page_needs_no_other_file_and_agrees_with_the_report() {
    let folder = tempfile::tempdir().unwrap();
    let (page, report) = page(folder.path(), &with(&[]));
    for reference in [
        "http:", "https:", "//www", "src=", "href=", "url(", "@import", "{{", "}}\n</",
    ] {
        assert!(!page.contains(reference), "{reference}");
    }
    assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"));
    let data = data(&page);
    assert_equals_report(&data, &report);
    let states = &data["states"];
    assert_eq!(states["index"], serde_json::json!([0, 1, 2, 3, 4]));
    assert_eq!(
        states["load_factor"],
        serde_json::json!([0.0, 0.25, 0.5, 0.75, 1.0])
    );
    let reached = report.facts.reached.as_ref().unwrap();
    assert_eq!(
        states["curve"][4],
        serde_json::json!([reached.displacement, reached.load])
    );
    assert!((reached.load - 2.0).abs() < 1e-12 && reached.stiffness.unwrap() > 0.0);
    assert!(data["peak"].is_null() && page.contains("Panels stay in the plane"));
    // The clamp holds the panel against the force.
    let reactions = floats(&states["reactions"]);
    assert_eq!(reactions.len(), 5 * 3);
    assert!((reactions[12] + 2.0).abs() < 1e-4, "{reactions:?}");
    assert_eq!(floats(&states["energy"]).len(), 5 * 12);
    assert_eq!(floats(&states["forces"])[..36], [0.0; 36]);
    for missing in ["damage", "damage_peak", "spread"] {
        assert!(states.get(missing).is_none(), "{missing}");
    }
    // The terms of the objective add up to the loss.
    let history = &data["history"];
    for (i, loss) in history["loss"].as_array().unwrap().iter().enumerate() {
        let terms = history["terms"].as_array().unwrap().iter();
        let sum: f64 = terms.map(|term| term[1][i].as_f64().unwrap()).sum();
        assert!((sum / loss.as_f64().unwrap() - 1.0).abs() < 1e-12);
    }
    assert!(data["budget"].is_null());
    let facts = data["facts"].as_array().unwrap().iter();
    assert_eq!(facts.count(), report.fact_rows().len());
    assert!(data["scene"].as_str().unwrap().contains("k_theta = 300.0"));
}

/// So large a load drives one of the twelve hinges out of the domain.
#[test]
fn damage_is_not_known_once_a_hinge_has_left_the_domain() {
    let folder = tempfile::tempdir().unwrap();
    weights(folder.path(), &[]);
    let (page, report) = page(
        folder.path(),
        &learned(&[("force = [2.0, 0.0]", "force = [8.0, 0.0]")]),
    );
    let data = data(&page);
    let rows = report.budget.as_ref().unwrap().rows();
    assert_eq!(data["budget"]["rows"], serde_json::json!(rows));
    assert_equals_report(&data, &report);
    let [damage, inside] = ["damage", "inside"].map(|name| floats(&data["states"][name]));
    let largest = floats(&data["hinges"]["damage"]);
    let count = report.hinges.len();
    let states = damage.len() / count;
    let mut known = 0;
    for (h, row) in report.hinges.iter().enumerate() {
        let mut left = false;
        // The flat sheet has no damage.
        assert_eq!(damage[h], 0.0);
        for i in 1..states {
            left |= inside[i * count + h] == 0.0;
            assert_eq!(damage[i * count + h].is_nan(), left, "hinge {h}, state {i}");
        }
        let most = (1..states)
            .map(|i| damage[i * count + h])
            .fold(0.0, f32::max);
        match row.damage {
            None => assert!(left && largest[h].is_nan()),
            Some(damage) => {
                known += 1;
                assert_close(most, damage, "D");
                assert_close(largest[h], damage, "largest D");
            }
        }
    }
    assert!((1..count).contains(&known), "{known} of {count} are known");
    assert!(data["domain"]["supports"].is_array());
}

#[test]
fn a_sheet_on_pins_shows_its_opening_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let pins = [
        ("hinge = \"linear\"", "hinge = \"pin\""),
        (
            "[linear]\nk_a = 400.0\nk_s = 250.0\nk_theta = 300.0",
            "[pin]\nopening_deg = 30.0",
        ),
        ("[[supports]]\npanel = [0, 1]\nkind = \"clamp\"", ""),
        ("[[loads]]\npanel = [2, 1]\nforce = [2.0, 0.0]", ""),
        ("compression = 0.01", ""),
        ("steps = 25", "steps = 3"),
    ];
    let (page, report) = page(folder.path(), &with(&pins));
    let data = data(&page);
    let states = &data["states"];
    for missing in [
        "energy",
        "forces",
        "damage",
        "damage_peak",
        "spread",
        "curve",
    ] {
        assert!(states.get(missing).is_none(), "{missing}");
    }
    assert!(data["stroke"].is_null() && data["domain"].is_null());
    let deformations = floats(&states["deformations"]);
    assert_eq!(deformations.len(), 21 * 12 * 3);
    for i in 0..21 {
        let theta = deformations[36 * i + 2];
        let expected = report.hinges[0].theta_deg.to_radians() * i as f64 / 20.0;
        assert!(
            (f64::from(theta) - expected).abs() < 1e-6,
            "{i}: {theta} {expected}"
        );
    }
    let text = report.to_string();
    assert!(
        !text.contains("load reached") && text.contains("pins"),
        "{text}"
    );
}

#[test]
fn no_title_ends_the_element_that_holds_it() {
    let folder = tempfile::tempdir().unwrap();
    let title = "</script><script>alert('1')</script> \\\"quoted\\\" {{data}} <!-- \u{2028} \u{1f389} &amp; <b>";
    let changes = [("Test sheet", title), ("steps = 25", "steps = 1")];
    let (page, report) = page(folder.path(), &with(&changes));
    assert!(report.title.contains("\"quoted\""));
    assert_eq!(data(&page)["title"], report.title);
    // The two scripts of the page, and no other element.
    assert_eq!(page.matches("<script").count(), 2);
    assert_eq!(page.matches("</script").count(), 2);
    assert!(!page.contains("<b>") && !page.contains("<!--"));
    assert!(page.contains("<title>&lt;/script&gt;"));
}

/// 3600 panels and 7080 hinges at 21 openings: states are left out, but neither the flat nor the last one.
#[test]
fn the_page_of_a_large_sheet_stays_below_five_megabytes() {
    let folder = tempfile::tempdir().unwrap();
    let large = [
        ("panels = [3, 3]", "panels = [60, 60]"),
        ("[1200.0, 1200.0]", "[20000.0, 20000.0]"),
        ("[700.0, 550.0]", "[10000.0, 10000.0]"),
        ("radius = 750.0", "radius = 12500.0"),
        ("hinge = \"linear\"", "hinge = \"pin\""),
        (
            "[linear]\nk_a = 400.0\nk_s = 250.0\nk_theta = 300.0",
            "[pin]\nopening_deg = 30.0",
        ),
        ("[[supports]]\npanel = [0, 1]\nkind = \"clamp\"", ""),
        ("[[loads]]\npanel = [2, 1]\nforce = [2.0, 0.0]", ""),
        ("compression = 0.01", ""),
        ("start_noise = 0.05", "start_noise = 0.0"),
        ("steps = 25", "steps = 1"),
    ];
    let (page, report) = page(folder.path(), &with(&large));
    assert_eq!(report.hinges.len(), 7080);
    assert!(page.len() < 5_000_000, "{} bytes", page.len());
    let data = data(&page);
    let index: Vec<u64> = serde_json::from_value(data["states"]["index"].clone()).unwrap();
    assert!((2..21).contains(&index.len()), "{index:?}");
    assert_eq!((index[0], index[index.len() - 1]), (0, 20));
    assert_equals_report(&data, &report);
    // The text lists the worst hinges only.
    let text = report.to_string();
    assert!(
        text.lines().count() < 80 && text.contains("the worst 20 of 7080 hinges"),
        "{text}"
    );
}
