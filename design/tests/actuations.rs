//! The sheet of section 3.2 under its first actuation: what passes through it, and when it gives way.

use design::degeneration::{Degeneration, last_jump};
use design::equilibrium::Status;
use design::force_transmission::ForceTransmission;
use design::gradient::{Deployment, DesignProblem};
use design::scene::{Scene, SceneConfig};
use design::tension_routes::tension_routes;
use design::validity::total_overlap;
use std::path::Path;

/// The uniform sheet under the scene's loads times `factor`.
fn uniform(factor: f64) -> (DesignProblem, Deployment) {
    changed("actuation-1.toml", |config| config.scale_loads(factor))
}

/// The uniform sheet of a shipped scene that was changed.
fn changed(name: &str, change: impl Fn(&mut SceneConfig)) -> (DesignProblem, Deployment) {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/scenes");
    let path = scenes.join(name);
    let mut config: SceneConfig = hinge::config::read(&path).unwrap();
    config.objective.balance = false;
    change(&mut config);
    let scene = Scene::new(config, &path).unwrap();
    let problem = scene.problem().unwrap();
    let deployment = problem.deploy(&scene.start()).unwrap();
    (problem, deployment)
}

#[test]
fn the_energies_of_the_interfaces_are_the_stored_energy_and_tension_reaches_the_load() {
    let (problem, deployment) = uniform(1.0);
    assert_eq!(Degeneration::of(&deployment), None);
    let transmission = ForceTransmission::new(&problem, &deployment).unwrap();
    let interfaces = transmission.interfaces.iter();
    let stored: f64 = interfaces.map(|it| it.translational + it.rotational).sum();
    let last = deployment.final_step();
    let expected: f64 = last.energies.iter().sum();
    assert!(
        (stored / expected - 1.0).abs() < 1e-12,
        "{stored} {expected}"
    );
    let shares = transmission.shares();
    let whole = shares.tension + shares.compression + shares.shear;
    assert!((whole - 1.0).abs() < 1e-12);
    assert!(shares.rotation > 0.95 && shares.non_rotational > 1.0 - shares.rotation);
    // The loaded panel is [7, 5]: every pull on it comes along a route.
    let routes = tension_routes(&transmission);
    assert!(
        routes
            .iter()
            .any(|route| route.panels.contains(&(5 * 15 + 7)))
    );
    // Where a hinge is compressed two corners overlap a little; the paper stays below this too.
    assert!(total_overlap(&deployment.sheet, &last.configuration) < 3e-6);
}

#[test]
fn a_sheet_that_is_pushed_shut_is_no_longer_deployed() {
    let (_, deployment) = uniform(-0.1);
    let hinges = match Degeneration::of(&deployment) {
        Some(Degeneration::Contact { hinges }) => hinges,
        other => panic!("{other:?}"),
    };
    assert!((1..=275).contains(&hinges));
    let pressed = total_overlap(&deployment.sheet, &deployment.final_step().configuration);
    assert!(pressed > 0.0 && pressed < 0.05, "{pressed}");
    assert!(last_jump(&deployment).is_none_or(|jump| (0.0..=1.0).contains(&jump)));
}

/// Six times the pull at the corner of the sheet presses panels shut before they snap open: the tangent
/// of the flat sheet leads them through each other.
#[test]
fn a_sheet_that_is_pressed_shut_opens_whatever_the_load_steps() {
    let energy = |load_steps: usize| {
        let (_, deployment) = changed("capacity.toml", |config| {
            config.load_steps = load_steps;
            config.loads[1].force = config.loads[1].force.map(|force| 6.0 * force);
        });
        let last = deployment.at_full_load().unwrap();
        assert_eq!(deployment.path[0].status, Status::LimitPoint);
        last.energies.iter().sum::<f64>()
    };
    let [coarse, fine] = [10, 20].map(energy);
    assert!((coarse / fine - 1.0).abs() < 1e-9, "{coarse} {fine}");
}
