//! Findings about a run as a whole: what the model leaves out, the load of a driven path, weights
//! that are inaccurate.

use super::learned::{brittle, learned, weights};
use super::*;
use analysis::actuation_curve::ActuationCurve;
use analysis::design_checks::{DesignChecks, WholeSheet};
use output::listing::equilibrium;
use scene::Posture;
use scene::design_run::design_of_run;
use scene::target::TargetShape;
use support::severity::Severity;

/// The learned scene, run with changes of the card and of the scene.
fn finished(card: &[(&str, &str)], scene: &[(&str, &str)]) -> Finished {
    let folder = tempfile::tempdir().unwrap();
    weights(folder.path(), card);
    Finished::within(folder, &learned(scene))
}

fn report(card: &[(&str, &str)], scene: &[(&str, &str)]) -> Report {
    finished(card, scene).report
}

/// The posture of the learned scene, and others in its place.
const HELD_FLAT: &str = "kind = \"held-flat\"";
const LYING: (&str, &str) = (HELD_FLAT, "kind = \"lying\"");
const FREE: (&str, &str) = (HELD_FLAT, "kind = \"free\"");
const HANGING: (&str, &str) = (HELD_FLAT, "kind = \"hanging\"\ndown = [0.0, -2.0]");

/// 1.2 m x 1.2 m x 0.5 mm of 1390 kg/m^3.
const WEIGHT: f64 = 1.2 * 1.2 * 0.5e-3 * 1390.0 * 9.81;

const SHORT: (&str, &str) = ("steps = 6", "steps = 1");

/// Finite elements of the whole sheet replace the expectation for their posture, and their findings
/// are the report's; they are of one design.
#[test]
fn a_whole_sheet_by_finite_elements_is_in_the_report() {
    let run = finished(&[], &[FREE, SHORT]);
    let expected = one(&run.report, "leaves-plane").clone();
    let message = "the panels tilt by up to 7.0 deg".to_owned();
    let sheet = |support| WholeSheet {
        support,
        tilt_deg: 7.0,
        corners: [1.5, 4.0],
        load: Some([2.0, 1.9]),
        findings: vec![Severity::Error.finding(message.clone())],
    };
    let again = |support, design| {
        let checks = DesignChecks { levels: None, whole_sheet: Some(sheet(support)) };
        checks.write(&run.scene.output(), design).unwrap();
        write_results(&run.scene, &run.designed, false).unwrap()
    };
    let best = &run.designed.search.best;
    let report = again(Posture::Free, best);
    assert!(found(&report, "leaves-plane").is_empty());
    let finding = one(&report, "whole-sheet");
    assert_eq!(finding.severity, Severity::Error);
    assert_says(&finding.message, &message);
    assert!(!report.cut_file);
    assert_says(&run.file("report.txt"), "tilt by up to 7 deg; corners 1.5 mm (rms), 4 mm at most");
    // Held in another way it may stay flat: the expectation is stated too.
    let held = again(Posture::HeldFlat, best);
    assert_eq!(one(&held, "leaves-plane"), &expected);
    assert_eq!(found(&held, "whole-sheet").len(), 1);
    let mut other = best.clone();
    other.omega[0] += 0.1;
    assert!(found(&again(Posture::Free, &other), "whole-sheet").is_empty());
}

#[test]
fn a_learned_law_states_what_is_not_modelled() {
    for (posture, missing) in [
        ((HELD_FLAT, HELD_FLAT), "what holds the panels flat"),
        (LYING, "friction"),
        (HANGING, ""),
        (FREE, "the weight of the sheet"),
    ] {
        let report = report(&[], &[posture, SHORT]);
        let notes = found(&report, "not-modelled");
        // Its weight is in the model.
        assert_eq!(notes.is_empty(), posture == HANGING);
        for note in notes {
            assert_eq!(note.severity, Severity::Note);
            assert_says(&note.message, missing);
        }
        assert_close(value(&report, "weight").as_f64().unwrap(), WEIGHT, 1e-9);
        let text = report.document().to_string();
        let modelled = if posture == HANGING { "modelled" } else { "not modelled" };
        assert_says(&text, &format!("9.82 N, 491 % of the load; {modelled}"));
        // Ligaments of this film are 36 times as wide as it is thick; on a floor its weight keeps
        // it nearly flat.
        let expected = match posture {
            HANGING | FREE => Some(Severity::Error),
            LYING => Some(Severity::Warning),
            _ => None,
        };
        let leaves = found(&report, "leaves-plane");
        assert_eq!(leaves.first().map(|warning| warning.severity), expected);
    }
}

#[test]
fn a_weight_that_is_left_out_is_a_warning() {
    // 9.82 N are 5.0 % of 196 N.
    for (posture, force, expected) in [
        (FREE, "[195.0, 0.0]", 1),
        (FREE, "[198.0, 0.0]", 0),
        ((HELD_FLAT, HELD_FLAT), "[2.0, 0.0]", 0),
        (HANGING, "[2.0, 0.0]", 0),
    ] {
        let report = report(&[], &[posture, ("[2.0, 0.0]", force), SHORT]);
        let found = found(&report, "weight").len();
        assert_eq!(found, expected, "{posture:?} {force}");
    }
}

#[test]
fn friction_is_a_warning_beside_a_small_load() {
    let heavy = report(&[], &[LYING, SHORT]);
    assert_close(value(&heavy, "friction").as_f64().unwrap(), 0.3 * WEIGHT, 1e-12);
    let message = &one(&heavy, "friction").message;
    let shares = ["147 % of the load", "150 % of the load"];
    let stated = shares.iter().any(|share| message.contains(share));
    assert!(stated, "{message}");
    assert_says(&heavy.document().to_string(), "clamp, panel P3 (column 1, row 2), at (");
    // At 4.9 % of the load it is none.
    let light = report(&[], &[LYING, ("[2.0, 0.0]", "[60.5, 0.0]"), SHORT]);
    assert!(found(&light, "friction").is_empty());
}

/// The sheet hangs from its left side: its weight turns it, in load steps of its own.
#[test]
fn a_hanging_sheet_has_load_steps_of_its_weight() {
    let designed = finished(&[], &[HANGING, SHORT]).designed;
    let path = &designed.best.deployment.path;
    let weights: Vec<f64> = path.iter().map(|step| step.weight).collect();
    assert_eq!(weights, [0.5, 1.0, 1.0, 1.0, 1.0, 1.0]);
    let factors: Vec<f64> = path.iter().map(|step| step.load_factor).collect();
    assert_eq!(factors, [0.0, 0.0, 0.25, 0.5, 0.75, 1.0]);
    let mechanics = designed.problem.model.mechanics().unwrap();
    let curve = ActuationCurve::new(mechanics, &designed.best.deployment).unwrap();
    assert_eq!(curve.points.len(), 5, "it begins under the weight");
    assert!(path[1].configuration[5][1] < -1.0);
}

/// Weights that predict a large damage: the weight of the sheet is enough.
#[test]
fn a_ligament_that_tears_under_the_weight_alone_is_named() {
    // Along the pull, where the sheet is stiff.
    let aside = (HELD_FLAT, "kind = \"hanging\"\ndown = [1.0, 0.0]");
    for (posture, alone) in [(aside, true), ((HELD_FLAT, HELD_FLAT), false)] {
        let folder = tempfile::tempdir().unwrap();
        brittle(folder.path(), 1e4);
        let report = Finished::within(folder, &learned(&[posture, SHORT])).report;
        let message = &one(&report, "tearing").message;
        let named = message.contains("under the weight of the sheet alone");
        assert_eq!(named, alone, "{message}");
    }
}

/// 7 kg in place of 7 g.
#[test]
fn a_weight_in_another_unit_is_a_warning() {
    for (mass_g, expected) in [("49000.0", 0), ("51000.0", 1)] {
        let force = format!("force = [0.0, 0.0]\nmass_g = {mass_g}");
        let report = report(&[], &[HANGING, ("force = [2.0, 0.0]", &force), SHORT]);
        assert_eq!(found(&report, "hung-weight").len(), expected);
    }
}

#[test]
fn a_sheet_on_pins_has_no_equilibria_to_list() {
    let scene = shipped("pin-7x7", |_| ());
    let error = equilibrium(&scene.problem().unwrap(), &scene.start()).unwrap_err();
    assert!(error.to_string().starts_with("the level `pin` has no equilibrium"), "{error}");
}

/// A scene of these tests.
const STEEL_FILM: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/run/steel-film");

/// The steel sheet buckles at a small stroke, between two load steps of its scene: there the load
/// is largest.
#[test]
fn the_largest_load_of_a_driven_path_and_weak_weights_are_stated() {
    let steel = Finished::shipped(STEEL_FILM, |_| ());
    let report = &steel.report;
    let reached = report.reached.as_ref().unwrap();
    let peak = reached.peak.unwrap();
    let carried = peak.dead_load_reaches.unwrap();
    assert!(peak.load > 1.2 * reached.load && peak.displacement < 0.05 * reached.displacement);

    // The same path at a thousand load steps.
    let stored = design_of_run(&steel.scene).unwrap();
    let scene = shipped(STEEL_FILM, |config| config.load_steps = 1000);
    let problem = scene.problem().unwrap();
    let deployment = problem.deploy(&stored.unwrap()).unwrap();
    let mechanics = problem.model.mechanics().unwrap();
    let points = ActuationCurve::new(mechanics, &deployment).unwrap().points;
    let by_load = |one: &&[f64; 2], other: &&[f64; 2]| one[1].total_cmp(&other[1]);
    let [at, largest] = points.iter().max_by(by_load).copied().unwrap();
    let step = reached.displacement / 1000.0;
    assert_close(peak.load / largest, 1.0, 1e-3);
    assert_close(peak.displacement, at, 2.0 * step);
    let first = points.iter().find(|point| point[1] >= reached.load);
    assert_close(first.unwrap()[0], carried, step);

    let warning = one(report, "load-peak");
    assert_eq!(warning.severity, Severity::Warning);
    assert_says(&warning.message, "such as a hung weight, does not open this sheet");
    assert_says(&report.document().to_string(), "largest load");
    // The page draws the largest load between the load steps.
    let peak = serde_json::to_string(&[peak.displacement, peak.load]).unwrap();
    assert_says(&steel.file("run.html"), &format!("\"peak\":{peak}"));

    let warning = one(report, "weak-weights");
    assert_says(&warning.message, "F_s is off by 22.1 % at random states");
    let film = Finished::shipped("a4-polyester", |_| ()).report;
    assert!(found(&film, "weak-weights").is_empty());
    assert!(found(&film, "load-peak").is_empty());
}

/// Beyond the increments the load steps go on: the largest load is of the whole path.
#[test]
fn the_largest_load_is_not_below_that_reached() {
    for increments in [1, 3, 8] {
        let change = |config: &mut SceneConfig| config.solver.max_increments = increments;
        let report = Finished::shipped("a4-polyester", change).report;
        let reached = report.reached.as_ref().unwrap();
        let peak = reached.peak.unwrap();
        let most = reached.displacement * (1.0 + 1e-12);
        let inside = peak.load >= reached.load && peak.displacement <= most;
        assert!(inside, "{reached:?}");
    }
}

/// The shipped sheet on pins with changed keys, as it begins.
fn on_pins(change: impl Fn(&mut SceneConfig)) -> Finished {
    Finished::shipped("pin-7x7", |config| {
        config.optimiser.learning_rate = 1e-9;
        change(config);
    })
}

/// The finding stands in all that a person sees first.
#[test]
fn a_missed_target_is_a_warning_and_a_shape_that_is_another_an_error() {
    for (radius, expected) in [(2000.0, Severity::Warning), (4000.0, Severity::Error)] {
        let centre = [1400.0; 2];
        let run = on_pins(|config| config.target = TargetShape::Circle { centre, radius });
        let miss = &run.report.miss;
        assert_says(miss, "% of the longer side of the flat sheet");
        assert_eq!(run.file("report.txt").lines().nth(1), Some(&**miss));
        assert_says(&run.file("run.html"), miss);
        let ratio = run.report.after.outline_error / 2800.0;
        assert_eq!(ratio > 0.2, expected == Severity::Error, "{ratio}");
        assert_eq!(run.report.cut_file, ratio <= 0.2, "{ratio}");
        let found = one(&run.report, "target-missed");
        assert_eq!(found.severity, expected);
    }
}

/// Of pins as of any other law: at a negative opening the panels lie over each other.
#[test]
fn panels_that_lie_over_each_other_are_an_error() {
    for (opening_deg, expected) in [(60.0, 0), (0.0, 0), (-18.0, 1)] {
        let run = on_pins(|config| {
            let pin = config.pin.as_mut().unwrap();
            (pin.opening_deg, pin.held) = (opening_deg, true);
        });
        let found = found(&run.report, "panels-overlap");
        assert_eq!(found.len(), expected, "{opening_deg}: {found:?}");
        for error in found {
            assert_eq!(error.severity, Severity::Error);
            assert_says(&error.message, "mean opening of -18 deg");
            assert_says(&error.message, "panels lie over each other");
            assert!(!run.scene.output().join("cut.dxf").exists());
        }
    }
}

/// The forces on the way decide: in a pulled plate they hold the panels in the plane, in a pushed
/// one they tip them.
#[test]
fn a_plate_stays_in_its_plane_if_it_is_pulled_and_leaves_it_if_it_is_pushed() {
    let plate = |outwards: f64| {
        let run = Finished::shipped("a4-plate", |config| {
            let force = config.loads[0].force;
            config.loads[0].force = force.map(|component| outwards * component);
            config.drive.as_mut().unwrap().stroke = 20.0;
        });
        one(&run.report, "leaves-plane").clone()
    };
    let pulled = plate(1.0);
    assert_eq!(pulled.severity, Severity::Note);
    assert_says(&pulled.message, "by themselves they stay");
    let pushed = plate(-1.0);
    assert_eq!(pushed.severity, Severity::Warning);
    assert_says(&pushed.message, "they leave it where hinges open by");
}

#[test]
fn a_spot_check_outside_the_domain_is_a_warning() {
    let zero = r#"{"relative_rmse": 0.01, "median": 0.01}"#;
    let check = |inside: usize| {
        let quantities = ["energy", "f_a", "f_s", "m_theta", "damage", "damage_peak"];
        let errors: Vec<String> = quantities.map(|name| format!("\"{name}\": {zero}")).into();
        let errors = errors.join(", ");
        let errors = format!("{{\"rows\": 60, {errors}}}");
        format!("\"spot_check\": {{\"errors\": {errors}, \"inside\": {inside}}}, \"test_errors\"")
    };
    for (inside, expected) in [(29, 1), (30, 0)] {
        let with = check(inside);
        let report = report(&[("\"test_errors\"", &with)], &[]);
        let outside = found(&report, "spot-check-outside").len();
        assert_eq!(outside, expected, "{:?}", report.warnings);
    }
}
