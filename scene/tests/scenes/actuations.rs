//! Sheets of section 3.2 under load: load steps that cross no ridge of the energy.

use crate::changed;
use design::equilibrium::load_step::Status;
use design::pattern::design_vector::DesignVector;

/// A pull of six times the load at the corner of the sheet presses panels together before they snap
/// open: the tangent of the flat sheet predicts panels that pass through each other.
#[test]
fn a_sheet_that_is_pressed_closed_opens_with_any_number_of_load_steps() {
    let energy = |load_steps: usize| {
        let scene = changed("capacity.toml", |config| {
            config.load_steps = load_steps;
            // The roller at the loaded edge, and the transverse load outwards.
            (config.supports[0].panel, config.supports[1].panel) = ([0, 0], [0, 9]);
            config.loads[0].panel = [14, 5];
            config.loads[1].force = config.loads[1].force.map(|x| -6.0 * x);
        });
        let deployment = scene.problem().unwrap().deploy(&scene.start()).unwrap();
        assert_eq!(deployment.path[0].status, Status::LimitPoint);
        let last = deployment.at_full_load().unwrap();
        last.energies.iter().sum::<f64>()
    };
    let [coarse, fine] = [10, 20].map(energy);
    assert!((coarse / fine - 1.0).abs() < 1e-9, "{coarse} {fine}");
}

/// A design of the polyester sheet for which an increment of a tenth of the load crosses a ridge of
/// the learned energy into a minimum of much higher energy outside the training domain, which no
/// sheet can reach by itself.
#[test]
fn no_load_step_crosses_a_ridge_of_the_energy() {
    let design: DesignVector = serde_json::from_str(include_str!("ridge_3x3_design.json")).unwrap();
    let potential = |load_steps: usize| {
        let scene = changed("pet-3x3.toml", |config| config.load_steps = load_steps);
        let deployment = scene.problem().unwrap().deploy(&design).unwrap();
        deployment.at_full_load().unwrap().potential
    };
    let [coarse, middle, fine] = [5, 10, 40].map(potential);
    assert!((coarse / fine - 1.0).abs() < 1e-9, "{coarse} {fine}");
    assert!((middle / fine - 1.0).abs() < 1e-9, "{middle} {fine}");
}
