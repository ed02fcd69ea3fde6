//! The error budget of a sheet against sheets that have the errors.

use crate::changed;
use analysis::error_budget::{Effect, ErrorBudget, ErrorCause};
use design::Deployment;
use design::sheet::kinematics::deployed_corners;
use scene::{Posture, PostureConfig, Scene, SceneConfig};
use testkit::derivatives::{assert_close, assert_ratio};

fn film(change: impl Fn(&mut SceneConfig)) -> Scene {
    changed("a4-polyester.toml", |config| {
        config.solver.tolerance = 1e-12;
        change(config);
    })
}

fn deployed(scene: &Scene) -> Deployment {
    scene.problem().unwrap().deploy(&scene.start()).unwrap()
}

fn budget(scene: &Scene, residual: Option<f64>) -> ErrorBudget {
    let problem = scene.problem().unwrap();
    ErrorBudget::new(scene, &problem, &deployed(scene), residual).unwrap()
}

fn effect(budget: &ErrorBudget, cause: ErrorCause) -> Option<&Effect> {
    let part = budget.contributions.iter().find(|part| part.cause == cause);
    part.unwrap().effect.as_ref()
}

fn corners(of: &Deployment) -> Vec<[f64; 2]> {
    deployed_corners(&of.sheet, &of.final_step().configuration).concat()
}

/// The stress scales all forces alike: under a prescribed stroke no corner moves, and the load is
/// off by its deviation.
#[test]
fn an_error_of_the_stress_is_one_of_the_load() {
    let mut scene = film(|_| ());
    scene.material.stress_deviation = Some(0.04);
    let budget = budget(&scene, None);
    let effect = effect(&budget, ErrorCause::MaterialLaw).unwrap();
    assert!(effect.corners[1] < 1e-8, "{effect:?}");
    assert_close(effect.load.unwrap(), 0.04, 1e-9);
}

/// Two sheets of a thickness a little above and below.
#[test]
fn an_error_of_the_thickness_is_the_difference_of_two_sheets() {
    let (thickness, tolerance) = (0.1, 2e-5);
    let toleranced = film(|config| config.tolerances.thickness = Some(tolerance));
    let budget = budget(&toleranced, None);
    let found = effect(&budget, ErrorCause::Thickness).unwrap();
    let [thin, thick] = [-1.0, 1.0].map(|sign| {
        deployed(&film(|config| {
            // One standard deviation, half of the tolerance.
            let changed = thickness + 0.5 * sign * tolerance;
            config.process.r_win *= changed / thickness;
            config.thickness = Some(changed);
        }))
    });
    let load = |of: &Deployment| of.final_step().load_factor;
    let change = 0.5 * (load(&thick) - load(&thin)) / load(&deployed(&film(|_| ())));
    assert_ratio(found.load.unwrap(), change.abs(), 1e-3);
    let pairs = std::iter::zip(corners(&thin), corners(&thick));
    for ((thin, thick), by_corner) in pairs.zip(&found.by_corner) {
        let expected = 0.5 * f64::hypot(thick[0] - thin[0], thick[1] - thin[1]);
        assert_close(*by_corner, expected, 1e-3 * found.corners[1]);
    }
}

#[test]
fn what_is_known_adds_in_squares_and_is_a_lower_bound_if_a_part_is_not() {
    let budget = budget(&film(|_| ()), None);
    assert!(effect(&budget, ErrorCause::Kerf).is_none());
    assert!(budget.total.at_least);
    assert!(!budget.sum(|cause| cause == ErrorCause::LoadingPath).at_least);
    let square = |effect: &Effect| effect.corners[0].powi(2);
    let parts = budget.contributions.iter();
    let known = parts.filter_map(|part| part.effect.as_ref());
    let sum: f64 = known.map(square).sum();
    assert_ratio(square(&budget.total), sum, 1e-12);
    assert!(effect(&budget, ErrorCause::LoadingPath).unwrap().corners[0] > 0.0);
}

/// Its weights have a spot check, which was made inside of their domain.
#[test]
fn a_network_whose_error_is_not_known_says_why() {
    let scene = film(|config| config.surrogate.as_mut().unwrap().ensemble.clear());
    let mut deployment = deployed(&scene);
    deployment.path.last_mut().unwrap().inside[0] = false;
    let problem = scene.problem().unwrap();
    let budget = ErrorBudget::new(&scene, &problem, &deployment, None).unwrap();
    let mut parts = budget.contributions.iter();
    let network = parts.find(|part| part.cause == ErrorCause::Network).unwrap();
    assert_eq!(network.source, "no ensemble; hinges are outside the training domain");
}

/// Finite elements of every hinge replace the errors that they see.
#[test]
fn a_verified_sheet_has_the_residual_of_its_rounds() {
    let scene = film(|_| ());
    let budget = budget(&scene, Some(0.02));
    let mut parts = budget.contributions.iter();
    assert!(parts.all(|part| !part.cause.is_seen_by_elements()));
    let found = effect(&budget, ErrorCause::Balance).unwrap();
    assert_close(found.corners[0], 0.02, 1e-15);
}

/// The heights of a plate that nothing holds flat are a part of the sum, and not known if it leaves
/// its plane.
#[test]
fn a_plate_that_tilts_has_the_heights_of_its_corners() {
    let plate = |posture, change: fn(&mut SceneConfig)| {
        let scene = changed("a4-plate.toml", |config| {
            config.posture = Some(PostureConfig { kind: posture, down: None });
            change(config);
        });
        let budget = budget(&scene, None);
        let tilt = (budget.contributions.iter()).find(|part| part.cause == ErrorCause::Tilt);
        tilt.map(|tilt| (tilt.effect.clone(), budget.total))
    };
    assert!(plate(Posture::HeldFlat, |_| ()).is_none());
    let (tilt, total) = plate(Posture::Free, |_| ()).unwrap();
    let [rms, largest] = tilt.unwrap().corners;
    assert!(0.1 < rms && rms < largest && largest < 1.0, "{rms} {largest}");
    assert!(rms < total.corners[0]);
    let pushed = plate(Posture::Free, |config| {
        config.loads[0].force = config.loads[0].force.map(|component| -component);
        config.drive.as_mut().unwrap().stroke = 20.0;
    });
    assert!(pushed.unwrap().0.is_none());
}
