//! Findings about a run as a whole: what the model leaves out, the load of a driven path, weights that are inaccurate.

use super::learned::{learned, weights};
use super::{read, run};
use design::DesignError;
use design::analysis::actuation_curve::ActuationCurve;
use design::objective::design_problem::Model;
use design::scene::{Scene, SceneConfig};
use output::listing::EquilibriumListing;
use output::report::{Concern, Report, Severity, Warning};
use output::run_results::write_results;
use std::path::{Path, PathBuf};
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

#[test]
fn a_learned_law_states_what_is_not_modelled() {
    // 1.2 m x 1.2 m x 0.5 mm of 1390 kg/m^3, opened by 2 N.
    let heavy = report(&[], &[]);
    let weight = heavy.facts.self_weight;
    assert!((weight.weight - 1.2 * 1.2 * 0.5e-3 * 1390.0 * 9.81).abs() < 1e-9);
    assert!((weight.friction - 0.3 * weight.weight).abs() < 1e-12);
    let ratio = weight.over_load.unwrap();
    assert!((ratio - weight.weight / 2.0).abs() < 1e-12);
    let [note] = found(&heavy, Concern::NotModelled)[..] else {
        panic!("{:?}", heavy.warnings);
    };
    assert_eq!(note.severity, Severity::Note);
    for part in [
        "held flat",
        "leave the plane",
        "9.82 N",
        "491 % of the load",
        "2.95 N",
        "147 %",
    ] {
        assert!(note.message.contains(part), "{part}: {}", note.message);
    }
    let [warning] = found(&heavy, Concern::Weight)[..] else {
        panic!("{:?}", heavy.warnings);
    };
    assert_eq!(warning.severity, Severity::Warning);
    let text = heavy.to_string();
    assert!(
        text.contains("panels held flat") && text.contains("for a sheet that lies on a surface")
    );
    assert!(!text.contains("stay flat"), "{text}");

    // Above a tenth of the load the weight is a warning.
    for (force, expected) in [("[97.0, 0.0]", 1), ("[99.0, 0.0]", 0)] {
        let light = report(&[], &[("[2.0, 0.0]", force), ("steps = 6", "steps = 1")]);
        assert_eq!(found(&light, Concern::NotModelled).len(), 1);
        assert_eq!(found(&light, Concern::Weight).len(), expected, "{force}");
    }
}

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../configs/scenes/{name}.toml"))
}

#[test]
fn a_sheet_on_pins_has_no_equilibria_to_list() {
    let scene = Scene::read(&shipped("pin-7x7")).unwrap();
    let error = EquilibriumListing::new(&scene.problem().unwrap(), &scene.start()).unwrap_err();
    assert!(matches!(error, DesignError::NoMechanics));
}

/// A shipped scene in a folder, without a search.
fn unsearched(folder: &Path, name: &str) -> (Scene, Report) {
    let file = shipped(name);
    let mut config: SceneConfig = toml_file::read(&file).unwrap();
    config.optimiser.steps = 1;
    config.output = folder.join(name);
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
    let stored = design::scene::design_run::design_of_run(&scene, false).unwrap();
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
        warning.message.contains("a dead load of"),
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
    assert_eq!(found(&film, Concern::Weight).len(), 1, "16 % of the load");
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
