//! The page of a run: self-contained, and equal to the report.

use super::learned::{learned, weights};
use super::*;
use base64::Engine;
use serde_json::{Value, json};

/// The page of a run, and the data in it.
fn page(run: &Finished) -> (String, Value) {
    let page = run.file("run.html");
    let data = data(&page);
    (page, data)
}

/// The data of a page.
fn data(page: &str) -> Value {
    let (_, data) = page.split_once("id=\"run\">").unwrap();
    let (data, _) = data.split_once("</script>").unwrap();
    serde_json::from_str(data).unwrap()
}

fn floats(packed: &Value) -> Vec<f32> {
    let engine = base64::engine::general_purpose::STANDARD;
    let bytes = engine.decode(packed.as_str().unwrap()).unwrap();
    let (numbers, rest) = bytes.as_chunks::<4>();
    assert!(rest.is_empty());
    let numbers = numbers.iter().copied();
    numbers.map(f32::from_le_bytes).collect()
}

/// Half a unit in the last place of a 32-bit float, and its smallest normal number.
#[track_caller]
fn assert_single(found: f32, expected: f64) {
    let error = (f64::from(found) - expected).abs();
    let close = error <= 1e-7 * expected.abs() + 1e-37;
    assert!(close, "{found} {expected}");
}

/// Asserts that the numbers of all hinges in the last state are the numbers in the report.
fn assert_equals_report(data: &Value, report: &Report) {
    let (count, states) = (report.hinges.len(), &data["states"]);
    let deformations = floats(&states["deformations"]);
    let last = &deformations[deformations.len() - 3 * count..];
    let [w_lig, alpha] = ["w_lig", "alpha_deg"].map(|name| floats(&data["hinges"][name]));
    for row in &report.hinges {
        let h = row.hinge;
        assert_single(last[3 * h], row.eta_a * row.w_lig);
        assert_single(last[3 * h + 1], row.eta_s * row.w_lig);
        assert_single(last[3 * h + 2], row.theta_deg.to_radians());
        assert_single(w_lig[h], row.w_lig);
        assert_single(alpha[h], row.alpha_deg);
    }
}

#[test]
fn the_page_needs_no_other_file_and_agrees_with_the_report() {
    let run = Finished::new(SCENE);
    let ((page, data), report) = (page(&run), &run.report);
    for reference in
        ["http:", "https:", "//www", "src=", "href=", "url(", "@import", "{{", "}}\n</"]
    {
        assert!(!page.contains(reference), "{reference}");
    }
    assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"));
    assert_equals_report(&data, report);
    let states = &data["states"];
    assert_eq!(states["index"], json!([0, 1, 2, 3, 4]));
    assert_eq!(states["load_factor"], json!([0.0, 0.25, 0.5, 0.75, 1.0]));
    let reached = report.reached.as_ref().unwrap();
    let end = json!([reached.displacement, reached.load]);
    assert_eq!(states["curve"][4], end);
    assert_close(reached.load, 2.0, 1e-12);
    assert!(value(report, "stiffness").as_f64().unwrap() > 0.0);
    assert!(data["peak"].is_null() && page.contains("Panels stay in the plane"));
    // The clamp holds the panel against the force.
    let reactions = floats(&states["reactions"]);
    assert_eq!(reactions.len(), 5 * 3);
    assert!((reactions[12] + 2.0).abs() < 1e-4, "{reactions:?}");
    assert_eq!(floats(&states["energy"]).len(), 5 * 12);
    assert_eq!(floats(&states["forces"])[..36], [0.0; 36]);
    assert_without(states, &["damage", "damage_peak", "spread"]);
    // The terms of the objective add up to the loss.
    let history = &data["history"];
    for (i, loss) in history["loss"].as_array().unwrap().iter().enumerate() {
        let terms = history["terms"].as_array().unwrap().iter();
        let sum: f64 = terms.map(|term| term[1][i].as_f64().unwrap()).sum();
        assert_close(sum / loss.as_f64().unwrap(), 1.0, 1e-12);
    }
    assert!(data["budget"].is_null());
    assert_eq!(data["facts"], json!(report.facts));
    assert!(data["scene"].as_str().unwrap().contains("k_theta = 300.0"));
}

#[test]
fn a_trimmed_panel_is_drawn_as_its_boundary() {
    let corners = "[[0, 0], [1, 0], [1, 0.5], [0.5, 1.5], [0, 1]]";
    let trimmed = format!("trimmed = [{{ panel = [2, 2], corners = {corners} }}]");
    let cells = format!("\n[cells]\nvoids = [\"oo\", \"oo\"]\n{trimmed}\n");
    let run = Finished::new(&(SCENE.to_owned() + &cells));
    let panels = &page(&run).1["panels"];
    assert_eq!((&panels["trimmed"][0][0], &panels["places"][8]), (&json!(8), &json!([2, 2])));
    let (cell, boundary) = (floats(&panels["corners"]), floats(&panels["trimmed"][0][1]));
    assert_eq!((boundary.len(), &boundary[..4]), (10, &cell[64..68]));
    assert_eq!((panels["trimmed"].as_array().unwrap().len(), &panels["outline"]), (1, &json!([])));
}

fn assert_without(states: &Value, names: &[&str]) {
    for name in names {
        assert!(states[name].is_null(), "{name}");
    }
}

/// So large a load drives one of the twelve hinges out of the domain.
#[test]
fn damage_is_not_known_once_a_hinge_has_left_the_domain() {
    let folder = tempfile::tempdir().unwrap();
    weights(folder.path(), &[]);
    let pulled = learned(&[("force = [2.0, 0.0]", "force = [8.0, 0.0]")]);
    let run = Finished::within(folder, &pulled);
    let ((_, data), report) = (page(&run), &run.report);
    let table = report.budget.as_ref().unwrap().table();
    assert_eq!(data["budget"]["table"], json!(table));
    assert_equals_report(&data, report);
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
        let later = (1..states).map(|i| damage[i * count + h]);
        let most = later.fold(0.0, f32::max);
        match row.damage {
            None => assert!(left && largest[h].is_nan()),
            Some(damage) => {
                known += 1;
                assert_single(most, damage);
                assert_single(largest[h], damage);
            }
        }
    }
    assert!((1..count).contains(&known), "{known} of {count} are known");
    assert!(data["domain"]["supports"].is_array());
}

#[test]
fn a_sheet_on_pins_shows_its_opening_and_nothing_else() {
    let run = Finished::new(&with(&[&ON_PINS[..], &[("steps = 25", "steps = 3")]].concat()));
    let ((_, data), report) = (page(&run), &run.report);
    let states = &data["states"];
    let of_hinges = ["energy", "forces", "damage", "damage_peak", "spread"];
    assert_without(states, &[&of_hinges[..], &["curve"]].concat());
    assert!(data["stroke"].is_null() && data["domain"].is_null());
    let deformations = floats(&states["deformations"]);
    assert_eq!(deformations.len(), 21 * 12 * 3);
    for i in 0..21 {
        let theta = deformations[36 * i + 2];
        let expected = report.hinges[0].theta_deg.to_radians() * i as f64 / 20.0;
        assert_close(f64::from(theta), expected, 1e-6);
    }
    let text = report.document().to_string();
    assert_says(&text, "pins");
    assert!(!text.contains("load reached"), "{text}");
}

#[test]
fn no_title_ends_the_element_that_holds_it() {
    let title = "</script><script>alert('1')</script> \\\"quoted\\\" {{data}} <!-- \u{2028} \u{1f389} &amp; <b>";
    let run = Finished::new(&with(&[("Test sheet", title), QUICK]));
    let (page, data) = page(&run);
    assert_says(&run.report.title, "\"quoted\"");
    assert_eq!(data["title"], run.report.title);
    // The two scripts of the page, and no other element.
    assert_eq!(page.matches("<script").count(), 2);
    assert_eq!(page.matches("</script").count(), 2);
    assert!(!page.contains("<b>") && !page.contains("<!--"));
    assert!(page.contains("<title>&lt;/script&gt;"));
}

/// 3600 panels and 7080 hinges at 21 openings: states are left out, but neither the flat nor the
/// last one.
#[test]
fn the_page_of_a_large_sheet_stays_below_five_megabytes() {
    let large = [
        ("panels = [3, 3]", "panels = [60, 60]"),
        ("[1200.0, 1200.0]", "[20000.0, 20000.0]"),
        ("[700.0, 550.0]", "[10000.0, 10000.0]"),
        ("radius = 750.0", "radius = 12500.0"),
        ("start_noise = 0.05", "start_noise = 0.0"),
        QUICK,
    ];
    let run = Finished::new(&with(&[&ON_PINS[..], &large].concat()));
    let ((page, data), report) = (page(&run), &run.report);
    assert_eq!(report.hinges.len(), 7080);
    assert!(page.len() < 5_000_000, "{} bytes", page.len());
    let index: Vec<u64> = serde_json::from_value(data["states"]["index"].clone()).unwrap();
    assert!((2..21).contains(&index.len()), "{index:?}");
    assert_eq!((index[0], index[index.len() - 1]), (0, 20));
    assert_equals_report(&data, report);
    // The text lists the worst hinges only.
    let text = report.document().to_string();
    assert!(text.lines().count() < 80, "{text}");
    assert_says(&text, "the worst 20 of 7080 hinges");
}
