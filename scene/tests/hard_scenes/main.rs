//! Scenes drawn at random on which a path or a search once went wrong; the first part of a name
//! says how.

use design::equilibrium::load_step::{LoadStep, Status};
use design::hinge_law::Contact;
use design::objective::design_problem::{DesignError, DesignProblem, Model};
use design::optimise::outer_loop::{SearchState, optimise};
use design::pattern::design_vector::DesignVector;
use scene::{Scene, SceneConfig};
use std::convert::Infallible;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

/// Relative difference of the losses of one path, followed and corrected.
const SAME_LOSS: f64 = 1e-10;
/// Difference of two configurations of the same sheet (rad, or panel sizes).
const SAME: f64 = 1e-6;

fn folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/hard_scenes"))
}

/// A scene, and its problem with the contact and the hinge point that it was drawn with, which are
/// no keys.
fn drawn(name: &str, change: impl FnOnce(&mut SceneConfig)) -> (Scene, DesignProblem) {
    let path = folder().join(name).with_extension("toml");
    let mut keys: toml::Table = toml::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    let [contact, hinge_point] = ["contact", "hinge_point"].map(|key| keys.remove(key));
    let mut config: SceneConfig = keys.try_into().unwrap();
    change(&mut config);
    let scene = Scene::new(config, &path).unwrap();
    let mut problem = scene.problem().unwrap();
    if let Some(point) = hinge_point {
        problem.options.hinge_point = point.try_into().unwrap();
    }
    if let (Some(contact), Model::Equilibrium(mechanics)) = (contact, &mut problem.model) {
        let key = |name: &str| contact[name].as_float().unwrap();
        let [wall, begin] = ["phi_min_deg", "phi_cut_deg"].map(|name| key(name).to_radians());
        mechanics.contact = Some(Contact::new(key("stiffness"), wall, begin).unwrap());
    }
    (scene, problem)
}

/// The names of the scenes that begin so.
fn named(beginning: &str) -> Vec<String> {
    let files = std::fs::read_dir(folder()).unwrap();
    let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
    let names = names.filter_map(|name| Some(name.strip_suffix(".toml")?.to_owned()));
    let mut names: Vec<_> = names.filter(|name| name.starts_with(beginning)).collect();
    names.sort();
    assert!(!names.is_empty(), "{beginning}");
    names
}

/// The last state of a sheet that is followed in so many load steps.
fn deployed(name: &str, load_steps: usize) -> (LoadStep, f64) {
    let (scene, problem) = drawn(name, |config| config.load_steps = load_steps);
    let deployment = problem.deploy(&scene.start()).unwrap();
    let sheet = &deployment.sheet;
    let size = (sheet.outline.area() / sheet.panels.len() as f64).sqrt();
    (deployment.final_step().clone(), size)
}

/// Maximum difference of two states (rad, or panel sizes).
fn apart(a: &LoadStep, b: &LoadStep, size: f64) -> f64 {
    let panels = std::iter::zip(&a.configuration, &b.configuration);
    let differences = panels.flat_map(|(a, b)| {
        let pairs = std::iter::zip(a, b).zip([size, size, 1.0]);
        pairs.map(|((a, b), unit)| (a - b).abs() / unit)
    });
    differences.fold(0.0, f64::max)
}

fn reaches_one_state_at_full_load(name: &str) {
    let mut first = None;
    for load_steps in [10, 60] {
        let (last, size) = deployed(name, load_steps);
        let at = format!("{name}, {load_steps} load steps: {last}");
        assert!(last.status != Status::Diverged, "{at}");
        let stable = last.negative_pivots == 0;
        assert!(last.residual < 1e-6 && stable, "{at}");
        assert_eq!(last.descent_end, None, "{at}");
        let first = first.get_or_insert_with(|| last.clone());
        let difference = apart(first, &last, size);
        assert!(difference < SAME, "{difference:e}: {at}");
    }
}

#[test]
fn sheets_that_have_an_equilibrium_reach_full_load_with_any_number_of_load_steps() {
    let kinds = ["branch", "false-no-equilibrium", "load", "slow"];
    let names: Vec<String> = kinds.iter().flat_map(|kind| named(kind)).collect();
    let all = |names: &[String]| names.iter().for_each(|name| reaches_one_state_at_full_load(name));
    std::thread::scope(|scope| {
        for half in names.chunks(names.len().div_ceil(2)) {
            scope.spawn(|| all(half));
        }
    });
}

/// The design with the minimum loss that a search reports, and the losses of its steps.
fn searched(
    (scene, problem): (&Scene, &DesignProblem),
    steps: usize,
    sink: &mut dyn FnMut(&SearchState),
) -> SearchState {
    let optimiser = &scene.config.optimiser;
    let start = scene.start();
    let evaluation = problem.evaluate(&start).unwrap();
    let (method, rate) = (optimiser.method, optimiser.learning_rate);
    let mut state = SearchState::new(problem, start, &evaluation, method, rate);
    let stop = AtomicBool::new(false);
    let mut sink = |state: &SearchState| {
        sink(state);
        Ok::<(), Infallible>(())
    };
    let Ok(_) = optimise(problem, &mut state, steps, &stop, &mut sink);
    state
}

#[test]
fn a_search_through_jumps_does_not_end_above_its_start() {
    for name in named("corrected-path-linear") {
        let steps = if name.contains("lbfgs") { 150 } else { 40 };
        let (scene, problem) = drawn(&name, |config| config.solver.follow_every = 10);
        let found = searched((&scene, &problem), steps, &mut |_| {});
        let [start, best] = [&scene.start(), &found.best].map(|of| problem.loss(of).unwrap());
        assert!(best <= start, "{name}: {best} from {start}");
        assert!(found.branch_mismatch(), "{name} has no jump any more");
    }
}

/// Losses of a design with its path followed and corrected, and by how much their states differ at
/// most.
fn compared(problem: &DesignProblem, anchor: &DesignVector, design: &DesignVector) -> [f64; 3] {
    let known = problem.evaluate(anchor).unwrap().deployment.warm_start();
    let corrected = problem.evaluate_near(design, Some(&known)).unwrap();
    let followed = problem.evaluate(design).unwrap();
    let paths = [&followed, &corrected].map(|evaluation| &evaluation.deployment.path);
    let states = std::iter::zip(paths[0], paths[1]);
    let most = states.map(|(a, b)| apart(a, b, 1.0)).fold(0.0, f64::max);
    [followed.loss, corrected.loss, most]
}

/// Between two nearly perfect bifurcations of this sheet a panel turns to one side or the other; a
/// small change of the design exchanges the sides, without a jump.
#[test]
fn a_corrected_path_has_the_loss_of_the_followed_one_or_other_stable_states() {
    let (scene, problem) = drawn("corrected-path-pet-3x3-55", |_| {});
    let mut anchor = scene.start();
    let (mut same, mut on_another_arm) = (0, 0);
    searched((&scene, &problem), 60, &mut |state| {
        if state.last().followed {
            anchor = state.last_design().clone();
            return;
        }
        let [followed, corrected, apart] = compared(&problem, &anchor, state.last_design());
        let difference = (corrected / followed - 1.0).abs();
        if apart < SAME {
            assert!(difference < SAME_LOSS, "{difference:e}");
            same += 1;
        } else {
            on_another_arm += 1;
        }
    });
    assert!(same > 0 && on_another_arm > 0, "{same}, {on_another_arm}");
}

#[test]
fn a_descent_that_is_cut_short_says_which_limit_ended_it() {
    let message = |iterations: usize, increments: usize| {
        let (scene, problem) = drawn("false-no-equilibrium-1235", |config| {
            config.solver.max_iterations = iterations;
            config.solver.max_increments = increments;
        });
        let deployment = problem.deploy(&scene.start()).unwrap();
        let error = deployment.at_full_load().unwrap_err();
        assert!(matches!(error, DesignError::NoEquilibrium { .. }));
        error.to_string()
    };
    let iterations = message(60, 100_000);
    assert!(iterations.contains("at the last iteration"), "{iterations}");
    assert!(!iterations.contains("ligaments"), "{iterations}");
    let increments = message(1, 1);
    assert!(increments.contains("number of increments"), "{increments}");
}
