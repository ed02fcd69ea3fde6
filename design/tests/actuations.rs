//! Sheets of section 3.2 under load: load steps that cross no ridge of the energy.

use design::equilibrium::load_step::Status;
use design::objective::design_problem::DesignProblem;
use design::pattern::design_vector::DesignVector;
use design::scene::{Scene, SceneConfig};
use std::path::Path;

/// The problem of a shipped scene after a change.
fn changed(name: &str, change: impl FnOnce(&mut SceneConfig)) -> (DesignProblem, DesignVector) {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/scenes");
    let path = scenes.join(name);
    let mut config: SceneConfig = support::toml_file::read(&path).unwrap();
    change(&mut config);
    let scene = Scene::new(config, &path).unwrap();
    (scene.problem().unwrap(), scene.start())
}

/// A pull of six times the load at the corner of the sheet presses panels together before they snap open: the
/// tangent of the flat sheet predicts panels that pass through each other.
#[test]
fn a_sheet_that_is_pressed_closed_opens_with_any_number_of_load_steps() {
    let energy = |load_steps: usize| {
        let (problem, start) = changed("capacity.toml", |config| {
            config.load_steps = load_steps;
            // The roller at the loaded edge, and the transverse load outwards.
            (config.supports[0].panel, config.supports[1].panel) = ([0, 0], [0, 9]);
            config.loads[0].panel = [14, 5];
            config.loads[1].force = config.loads[1].force.map(|x| -6.0 * x);
        });
        let deployment = problem.deploy(&start).unwrap();
        assert_eq!(deployment.path[0].status, Status::LimitPoint);
        let last = deployment.at_full_load().unwrap();
        last.energies.iter().sum::<f64>()
    };
    let [coarse, fine] = [10, 20].map(energy);
    assert!((coarse / fine - 1.0).abs() < 1e-9, "{coarse} {fine}");
}

/// A design of the polyester sheet for which an increment of a tenth of the load crosses a ridge of the learned
/// energy into a minimum of much higher energy outside the training domain, which no sheet can reach by itself.
#[test]
fn no_load_step_crosses_a_ridge_of_the_energy() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let design = std::fs::read_to_string(folder.join("tests/cases/ridge_3x3_design.json"));
    let design: DesignVector = serde_json::from_str(&design.unwrap()).unwrap();
    let potential = |load_steps: usize| {
        let (problem, _) = changed("pet-3x3.toml", |config| config.load_steps = load_steps);
        let deployment = problem.deploy(&design).unwrap();
        deployment.at_full_load().unwrap().potential
    };
    let [coarse, middle, fine] = [5, 10, 40].map(potential);
    assert!((coarse / fine - 1.0).abs() < 1e-9, "{coarse} {fine}");
    assert!((middle / fine - 1.0).abs() < 1e-9, "{middle} {fine}");
}
