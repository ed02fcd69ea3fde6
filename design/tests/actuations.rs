//! The sheet of section 3.2 under its first actuation: force transmission and load capacity.

use design::analysis::degeneration::{Degeneration, last_jump};
use design::analysis::force_transmission::ForceTransmission;
use design::analysis::further_load::GivesWay;
use design::analysis::tension_lines::tension_lines;
use design::equilibrium::hinged_sheet::HingedSheet;
use design::equilibrium::load_step::Status;
use design::equilibrium::supports::{Dof, Load};
use design::objective::design_problem::{Deployment, DesignProblem, Model};
use design::pattern::design_vector::DesignVector;
use design::scene::{Scene, SceneConfig};
use design::sheet::validity::total_overlap;
use std::path::Path;

/// The uniform sheet under the scene's loads times `factor`.
fn uniform(factor: f64) -> (DesignProblem, Deployment) {
    changed("actuation-1.toml", |config| config.scale_loads(factor))
}

/// The uniform sheet of a shipped scene after a change.
fn changed(name: &str, change: impl Fn(&mut SceneConfig)) -> (DesignProblem, Deployment) {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/scenes");
    let path = scenes.join(name);
    let mut config: SceneConfig = support::toml_file::read(&path).unwrap();
    config.objective.balance = false;
    change(&mut config);
    let scene = Scene::new(config, &path).unwrap();
    let problem = scene.problem().unwrap();
    let deployment = problem.deploy(&scene.start()).unwrap();
    (problem, deployment)
}

#[test]
fn the_interface_energies_sum_to_the_stored_energy_and_tension_reaches_the_load() {
    let (problem, deployment) = uniform(1.0);
    assert_eq!(Degeneration::new(deployment.final_step()), None);
    let transmission = ForceTransmission::new(&problem, &deployment).unwrap();
    let interfaces = transmission.interfaces.iter();
    let stored: f64 = interfaces
        .map(|interface| interface.translational + interface.rotational)
        .sum();
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
    // The loaded panel is [7, 5]: a tension path reaches it.
    let lines = tension_lines(&transmission);
    assert!(lines.iter().any(|line| line.panels.contains(&(5 * 15 + 7))));
    // At a compressed hinge two corners overlap slightly; the paper's overlap is below this limit too.
    assert!(total_overlap(&deployment.sheet, &last.configuration) < 3e-6);
}

#[test]
fn a_sheet_that_is_pushed_closed_is_not_deployed() {
    let (_, deployment) = uniform(-0.1);
    let hinges = match Degeneration::new(deployment.final_step()) {
        Some(Degeneration::Contact { hinges }) => hinges,
        other => panic!("{other:?}"),
    };
    assert!((1..=275).contains(&hinges));
    let pressed = total_overlap(&deployment.sheet, &deployment.final_step().configuration);
    assert!(pressed > 0.0 && pressed < 0.05, "{pressed}");
    assert!(last_jump(&deployment).is_none_or(|jump| (0.0..=1.0).contains(&jump)));
}

/// The sheet of the load capacity with the roller at the loaded edge, and the transverse load outwards.
fn outwards_at_the_roller(config: &mut SceneConfig) {
    (config.supports[0].panel, config.supports[1].panel) = ([0, 0], [0, 9]);
    config.loads[0].panel = [14, 5];
    config.loads[1].scale(-1.0);
}

/// A pull of six times the load at the corner of the sheet presses panels together before they snap open: the
/// tangent of the flat sheet predicts panels that pass through each other.
#[test]
fn a_sheet_that_is_pressed_closed_opens_with_any_number_of_load_steps() {
    let energy = |load_steps: usize| {
        let (_, deployment) = changed("capacity.toml", |config| {
            config.load_steps = load_steps;
            outwards_at_the_roller(config);
            config.loads[1].scale(6.0);
        });
        let last = deployment.at_full_load().unwrap();
        assert_eq!(deployment.path[0].status, Status::LimitPoint);
        last.energies.iter().sum::<f64>()
    };
    let [coarse, fine] = [10, 20].map(energy);
    assert!((coarse / fine - 1.0).abs() < 1e-9, "{coarse} {fine}");
}

/// Dead loads confirm the maximum load found under displacement control: a slightly smaller load is carried
/// without a jump, a slightly larger one is not.
#[test]
fn dead_loads_cause_a_jump_at_the_maximum_further_load() {
    let (problem, deployment) = changed("capacity.toml", |config| {
        config.load_steps = 20;
        outwards_at_the_roller(config);
        config.loads.truncate(1);
    });
    // Inwards on the middle panel of the top edge.
    let loads = |factor: f64| {
        [Load {
            panel: 9 * 15 + 7,
            dof: Dof::UY,
            value: -247.7 * factor,
        }]
    };
    let found = problem
        .further_load(&deployment, &loads(1.0), 1000.0)
        .unwrap();
    assert_eq!(found.ended, Some(GivesWay::Falls));
    let carried = found.carried();
    assert!((0.1..2.0).contains(&carried), "{carried}");
    let jumps = |factor: f64| {
        let Model::Equilibrium(mechanics) = &problem.model else {
            panic!("a sheet under load");
        };
        let law = mechanics.law.prepare(&deployment.sheet.designs());
        let sheet = HingedSheet {
            sheet: &deployment.sheet,
            law: &*law,
            contact: mechanics.contact.as_ref(),
            damage_gradient: true,
        };
        let opened = deployment.final_step();
        let solver = mechanics
            .solver
            .followed_by(opened, &loads(factor), 20)
            .unwrap();
        let path = solver.path_from(sheet, opened.configuration.clone());
        path.iter().any(|step| step.status == Status::LimitPoint)
    };
    assert!(!jumps(0.999 * carried));
    assert!(jumps(1.001 * carried));
}

/// The whole couple of the third actuation passes through the panel that it acts on.
#[test]
fn a_couple_passes_through_its_panel() {
    let (problem, deployment) = changed("actuation-3.toml", |_| ());
    let transmission = ForceTransmission::new(&problem, &deployment).unwrap();
    let config: SceneConfig = support::toml_file::read(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/scenes/actuation-3.toml"),
    )
    .unwrap();
    let load = config.loads.iter().find(|load| load.couple != 0.0).unwrap();
    let [column, row] = load.panel;
    let through = transmission.moments[15 * row + column].interfaces;
    assert!(through > 0.999 * load.couple.abs(), "{through}");
    let max = (transmission.moments.iter())
        .map(|moment| moment.interfaces)
        .fold(0.0, f64::max);
    assert!(through == max && max < 1.5 * load.couple.abs(), "{max}");
}

/// A design of the polyester sheet for which an increment of a tenth of the load crosses a ridge of the learned
/// energy into a minimum of much higher energy outside the training domain, which no sheet can reach by itself.
#[test]
fn no_load_step_crosses_a_ridge_of_the_energy() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let scenes = folder.join("../configs/scenes");
    let design = std::fs::read_to_string(folder.join("tests/cases/ridge_3x3_design.json"));
    let design: DesignVector = serde_json::from_str(&design.unwrap()).unwrap();
    let potential = |load_steps: usize| {
        let path = scenes.join("pet-3x3.toml");
        let mut config: SceneConfig = support::toml_file::read(&path).unwrap();
        config.load_steps = load_steps;
        let problem = Scene::new(config, &path).unwrap().problem().unwrap();
        let deployment = problem.deploy(&design).unwrap();
        deployment.at_full_load().unwrap().potential
    };
    let [coarse, middle, fine] = [5, 10, 40].map(potential);
    assert!((coarse / fine - 1.0).abs() < 1e-9, "{coarse} {fine}");
    assert!((middle / fine - 1.0).abs() < 1e-9, "{middle} {fine}");
}
