//! Findings about a run as a whole: what the model leaves out, the load of a driven path, weights that are inaccurate.

use super::learned::{brittle, learned, weights};
use super::{read, run};
use design::DesignError;
use design::analysis::actuation_curve::ActuationCurve;
use design::objective::design_problem::Model;
use design::objective::target::TargetShape;
use design::scene::{Scene, SceneConfig};
use output::listing::equilibrium;
use output::report::{Concern, Report, Warning};
use output::run_results::write_results;
use std::path::{Path, PathBuf};
use support::severity::Severity;
use support::toml_file;

fn found(report: &Report, concern: Concern) -> Vec<&Warning> {
    let found = report.warnings.iter();
    found.filter(|warning| warning.concern == concern).collect()
}

/// The report of the learned scene with changes of the card and of the scene.
fn report(card: &[(&str, &str)], scene: &[(&str, &str)]) -> Report {
    let folder = tempfile::tempdir().unwrap();
    weights(folder.path(), card);
    let scene = read(folder.path(), &learned(scene));
    let designed = run(&scene, None).unwrap();
    write_results(&scene, &designed, false).unwrap()
}

/// The posture of the learned scene, and others in its place.
const HELD_FLAT: &str = "kind = \"held-flat\"";
const LYING: (&str, &str) = (HELD_FLAT, "kind = \"lying\"");
const FREE: (&str, &str) = (HELD_FLAT, "kind = \"free\"");
const HANGING: (&str, &str) = (HELD_FLAT, "kind = \"hanging\"\ndown = [0.0, -2.0]");

fn one(report: &Report, concern: Concern) -> &Warning {
    let [warning] = found(report, concern)[..] else {
        panic!("{concern:?}: {:?}", report.warnings);
    };
    warning
}

/// 1.2 m x 1.2 m x 0.5 mm of 1390 kg/m^3.
const WEIGHT: f64 = 1.2 * 1.2 * 0.5e-3 * 1390.0 * 9.81;

const SHORT: (&str, &str) = ("steps = 6", "steps = 1");

#[test]
fn a_learned_law_states_what_is_not_modelled() {
    for (posture, missing) in [
        ((HELD_FLAT, HELD_FLAT), "what holds the panels flat"),
        (LYING, "panels that lift off the surface"),
        (HANGING, "panels that leave the plane"),
        (FREE, "the weight of the sheet"),
    ] {
        let report = report(&[], &[posture, SHORT]);
        let note = one(&report, Concern::NotModelled);
        assert_eq!(note.severity, Severity::Note);
        assert!(note.message.contains(missing), "{}", note.message);
        let weight = &report.facts.self_weight;
        assert!((weight.weight - WEIGHT).abs() < 1e-9);
        assert!((weight.over_load.unwrap() - WEIGHT / 2.0).abs() < 1e-9);
        assert_eq!(weight.is_modelled, posture == HANGING);
        let text = report.to_string();
        assert!(text.contains("9.82 N, 491 % of the load"), "{text}");
        // Gamma is of a sheet that lies.
        assert_eq!(text.contains("minimum Gamma"), posture == LYING, "{text}");
        // Ligaments of this film are 36 times as wide as it is thick; on a floor its weight keeps it nearly flat.
        let expected = match posture {
            HANGING | FREE => Some(Severity::Error),
            LYING => Some(Severity::Warning),
            _ => None,
        };
        let leaves = found(&report, Concern::LeavesPlane);
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
        assert_eq!(
            found(&report, Concern::Weight).len(),
            expected,
            "{posture:?} {force}"
        );
    }
}

#[test]
fn friction_is_a_warning_beside_a_small_load() {
    let heavy = report(&[], &[LYING, SHORT]);
    let lying = heavy.facts.self_weight.lying.as_ref().unwrap();
    assert!((lying.friction - 0.3 * WEIGHT).abs() < 1e-12);
    let warning = one(&heavy, Concern::Friction);
    assert!(
        warning.message.contains("147 % of the load")
            || warning.message.contains("150 % of the load"),
        "{}",
        warning.message
    );
    let text = heavy.to_string();
    assert!(text.contains("clamp, panel P3 [0,1], at ("), "{text}");
    // At 4.9 % of the load it is none.
    let light = report(&[], &[LYING, ("[2.0, 0.0]", "[60.5, 0.0]"), SHORT]);
    assert!(found(&light, Concern::Friction).is_empty());
}

/// The sheet hangs from its left side: its weight turns it, in load steps of its own.
#[test]
fn a_hanging_sheet_has_load_steps_of_its_weight() {
    let folder = tempfile::tempdir().unwrap();
    weights(folder.path(), &[]);
    let scene = read(folder.path(), &learned(&[HANGING, SHORT]));
    let designed = run(&scene, None).unwrap();
    let path = &designed.best.deployment.path;
    let weights: Vec<f64> = path.iter().map(|step| step.weight).collect();
    assert_eq!(weights, [0.5, 1.0, 1.0, 1.0, 1.0, 1.0]);
    let factors: Vec<f64> = path.iter().map(|step| step.load_factor).collect();
    assert_eq!(factors, [0.0, 0.0, 0.25, 0.5, 0.75, 1.0]);
    let mechanics = designed.problem.model.mechanics().unwrap();
    let curve = ActuationCurve::new(mechanics, &designed.best.deployment).unwrap();
    assert_eq!(curve.points.len(), 5, "it begins under the weight");
    assert!(
        path[1].configuration[5][1] < -1.0,
        "{:?}",
        path[1].configuration[5]
    );
}

/// Weights that predict a large damage: the weight of the sheet is enough.
#[test]
fn a_ligament_that_tears_under_the_weight_alone_is_named() {
    // Along the pull, where the sheet is stiff.
    let aside = (HELD_FLAT, "kind = \"hanging\"\ndown = [1.0, 0.0]");
    for (posture, alone) in [(aside, true), ((HELD_FLAT, HELD_FLAT), false)] {
        let folder = tempfile::tempdir().unwrap();
        brittle(folder.path(), 1e4);
        let scene = read(folder.path(), &learned(&[posture, SHORT]));
        let designed = run(&scene, None).unwrap();
        let report = write_results(&scene, &designed, false).unwrap();
        let message = &one(&report, Concern::Tearing).message;
        assert_eq!(
            message.contains("under the weight of the sheet alone"),
            alone,
            "{message}"
        );
    }
}

/// 7 kg in place of 7 g.
#[test]
fn a_weight_in_another_unit_is_a_warning() {
    let mass = |mass_g: &str| format!("force = [0.0, 0.0]\nmass_g = {mass_g}");
    for (mass_g, expected) in [("49000.0", 0), ("51000.0", 1)] {
        let force = mass(mass_g);
        let report = report(&[], &[HANGING, ("force = [2.0, 0.0]", &force), SHORT]);
        assert_eq!(found(&report, Concern::HungWeight).len(), expected);
    }
}

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../configs/scenes/{name}.toml"))
}

#[test]
fn a_sheet_on_pins_has_no_equilibria_to_list() {
    let scene = Scene::read(&shipped("pin-7x7")).unwrap();
    let error = equilibrium(&scene.problem().unwrap(), &scene.start()).unwrap_err();
    assert!(matches!(error, DesignError::NoMechanics));
}

/// A shipped scene in a folder, without a search.
fn unsearched(folder: &Path, name: &str) -> (Scene, Report) {
    changed(folder, name, |_| ())
}

/// The same with changed keys.
fn changed(folder: &Path, name: &str, change: impl Fn(&mut SceneConfig)) -> (Scene, Report) {
    let file = shipped(name);
    let mut config: SceneConfig = toml_file::read(&file).unwrap();
    config.optimiser.steps = 1;
    config.output = folder.join(name);
    change(&mut config);
    let scene = Scene::new(config, &file).unwrap();
    let designed = run(&scene, None).unwrap();
    let report = write_results(&scene, &designed, false).unwrap();
    (scene, report)
}

/// The steel sheet buckles at a small stroke, between two load steps of its scene: there the load is largest.
#[test]
fn the_largest_load_of_a_driven_path_is_stated() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, report) = unsearched(folder.path(), "steel-1250x1500");
    let reached = report.facts.reached.as_ref().unwrap();
    let peak = reached.peak.unwrap();
    let carried = peak.dead_load_reaches.unwrap();
    assert!(peak.load > 1.2 * reached.load && peak.displacement < 0.05 * reached.displacement);

    // The same path at a thousand load steps.
    let stored = design::scene::design_run::design_of_run(&scene).unwrap();
    let mut config = scene.config.clone();
    config.load_steps = 1000;
    let scene = Scene::new(config, &shipped("steel-1250x1500")).unwrap();
    let problem = scene.problem().unwrap();
    let deployment = problem.deploy(&stored.unwrap()).unwrap();
    let Model::Equilibrium(mechanics) = &problem.model else {
        panic!("no equilibrium");
    };
    let points = ActuationCurve::new(mechanics, &deployment).unwrap().points;
    let by_load = |one: &&[f64; 2], other: &&[f64; 2]| one[1].total_cmp(&other[1]);
    let [at, largest] = points.iter().max_by(by_load).copied().unwrap();
    let step = reached.displacement / 1000.0;
    assert!(
        (peak.load / largest - 1.0).abs() < 1e-3,
        "{peak:?} {largest}"
    );
    assert!((peak.displacement - at).abs() < 2.0 * step, "{peak:?} {at}");
    let first = points
        .iter()
        .find(|point| point[1] >= reached.load)
        .unwrap();
    assert!((first[0] - carried).abs() < step, "{peak:?} {first:?}");

    let [warning] = found(&report, Concern::LoadPeak)[..] else {
        panic!("{:?}", report.warnings);
    };
    assert_eq!(warning.severity, Severity::Warning);
    assert!(
        warning
            .message
            .contains("such as a hung weight, does not open this sheet"),
        "{}",
        warning.message
    );
    assert!(report.to_string().contains("largest load"));
}

/// Beyond the increments the load steps go on: the largest load is of the whole path.
#[test]
fn the_largest_load_is_not_below_that_reached() {
    for increments in [1, 3, 8] {
        let folder = tempfile::tempdir().unwrap();
        let file = shipped("a4-polyester");
        let mut config: SceneConfig = toml_file::read(&file).unwrap();
        config.optimiser.steps = 1;
        config.solver.max_increments = increments;
        config.output = folder.path().join("run");
        let scene = Scene::new(config, &file).unwrap();
        let designed = run(&scene, None).unwrap();
        let report = write_results(&scene, &designed, true).unwrap();
        let reached = report.facts.reached.as_ref().unwrap();
        let peak = reached.peak.unwrap();
        assert!(peak.load >= reached.load, "{reached:?}");
        assert!(
            peak.displacement <= reached.displacement * (1.0 + 1e-12),
            "{reached:?}"
        );
    }
}

/// The page draws the largest load between the load steps.
#[test]
fn the_run_page_knows_the_largest_load() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, report) = unsearched(folder.path(), "steel-1250x1500");
    let page = std::fs::read_to_string(scene.output().join("run.html")).unwrap();
    let peak = report.facts.reached.as_ref().unwrap().peak.unwrap();
    let peak = serde_json::to_string(&[peak.displacement, peak.load]).unwrap();
    assert!(page.contains(&format!("\"peak\":{peak}")), "{peak}");
}

/// The shipped sheet on pins with changed keys, as it begins.
fn on_pins(folder: &Path, change: impl Fn(&mut SceneConfig)) -> (Scene, Report) {
    changed(folder, "pin-7x7", |config| {
        config.optimiser.learning_rate = 1e-9;
        change(config);
    })
}

/// The finding stands in all that a person sees first.
#[test]
fn a_missed_target_is_a_warning_and_a_shape_that_is_another_an_error() {
    let severity = |radius: f64| {
        let folder = tempfile::tempdir().unwrap();
        let (scene, report) = on_pins(folder.path(), |config| {
            config.target = TargetShape::Circle {
                centre: [1400.0; 2],
                radius,
            }
        });
        let ratio = report.after.outline_error / 2800.0;
        let run = |name| std::fs::read_to_string(scene.output().join(name)).unwrap();
        let first = run("report.txt").lines().nth(1).map(str::to_owned);
        assert_eq!(first, Some(report.miss()));
        assert!(
            report
                .miss()
                .contains("% of the longer side of the flat sheet")
        );
        assert!(run("run.html").contains(&report.miss()));
        let found = found(&report, Concern::TargetMissed);
        assert_eq!(report.cut_file, ratio <= 0.2, "{ratio}");
        (ratio, found.first().map(|warning| warning.severity))
    };
    for (radius, expected) in [(2000.0, Severity::Warning), (4000.0, Severity::Error)] {
        let (ratio, found) = severity(radius);
        assert!(
            (ratio > 0.2) == (expected == Severity::Error),
            "{radius}: {ratio}"
        );
        assert_eq!(found, Some(expected), "{radius}: {ratio}");
    }
}

/// Of pins as of any other law: at a negative opening the panels lie over each other.
#[test]
fn panels_that_lie_over_each_other_are_an_error() {
    for (opening_deg, expected) in [(60.0, 0), (0.0, 0), (-18.0, 1)] {
        let folder = tempfile::tempdir().unwrap();
        let (scene, report) = on_pins(folder.path(), |config| {
            let pin = config.pin.as_mut().unwrap();
            (pin.opening_deg, pin.held) = (opening_deg, true);
        });
        let found = found(&report, Concern::PanelsOverlap);
        assert_eq!(found.len(), expected, "{opening_deg}: {found:?}");
        for error in found {
            assert_eq!(error.severity, Severity::Error);
            assert!(error.message.contains("mean opening of -18 deg"), "{error}");
            assert!(
                error.message.contains("panels lie over each other"),
                "{error}"
            );
            assert!(!scene.output().join("cut.dxf").exists());
        }
    }
}

/// Larger plates were found off although their ligaments are narrow; of one that is pushed nothing was measured.
#[test]
fn a_plate_is_not_called_flat() {
    let flatness = |outwards: f64| {
        let folder = tempfile::tempdir().unwrap();
        let (_, report) = changed(folder.path(), "a4-plate", |config| {
            let force = config.loads[0].force;
            config.loads[0].force = force.map(|component| outwards * component);
            config.drive.as_mut().unwrap().stroke = 20.0;
        });
        let found = found(&report, Concern::LeavesPlane);
        (found.first()).map(|warning| (warning.severity, warning.message.clone()))
    };
    let (severity, message) = flatness(1.0).unwrap();
    assert_eq!(severity, Severity::Warning);
    for said in [
        "not known",
        "1.3 % of their size off",
        "tilt by up to 8 deg",
    ] {
        assert!(message.contains(said), "{message}");
    }
    assert_eq!(flatness(-1.0), None);
}

#[test]
fn weights_with_large_errors_are_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let (_, steel) = unsearched(folder.path(), "steel-1250x1500");
    let [warning] = found(&steel, Concern::WeakWeights)[..] else {
        panic!("{:?}", steel.warnings);
    };
    assert!(
        warning.message.contains("F_s is off by 25.3 %"),
        "{}",
        warning.message
    );
    let (_, film) = unsearched(folder.path(), "a4-polyester");
    assert!(found(&film, Concern::WeakWeights).is_empty());
    assert!(
        found(&film, Concern::LoadPeak).is_empty(),
        "{:?}",
        film.warnings
    );
}

#[test]
fn a_spot_check_outside_the_domain_is_a_warning() {
    let zero = r#"{"relative_rmse": 0.01, "median": 0.01}"#;
    let check = |inside: usize| {
        let quantities = ["energy", "f_a", "f_s", "m_theta", "damage", "damage_peak"];
        let errors: Vec<String> = quantities.map(|name| format!("\"{name}\": {zero}")).into();
        let errors = errors.join(", ");
        format!(
            "\"spot_check\": {{\"errors\": {{\"rows\": 60, {errors}}}, \"inside\": {inside}}}, \"test_errors\""
        )
    };
    for (inside, expected) in [(29, 1), (30, 0)] {
        let with = check(inside);
        let report = report(&[("\"test_errors\"", &with)], &[]);
        let outside = found(&report, Concern::WeakWeights);
        let outside: Vec<_> = outside
            .iter()
            .filter(|warning| warning.message.contains("of 60 states"))
            .collect();
        assert_eq!(outside.len(), expected, "{:?}", report.warnings);
    }
}
