//! The response of an equilibrium to errors of its hinge forces: against equilibria with a law that
//! has them, and in closed form.

use crate::prelude::*;
use analysis::actuation_curve::ActuationCurve;
use design::equilibrium::force_response::{ForceResponse, SheetChange};
use design::hinge_law::{CorrectedLaw, Correction, MissingForces};
use scene::{SupportConfig, SupportKind};

/// The A4 sheet after a change, without its ensemble.
fn film(change: impl Fn(&mut SceneConfig)) -> Scene {
    alone("a4-polyester.toml", |config| {
        config.solver.tolerance = 1e-12;
        change(config);
    })
}

fn whole_load(problem: &DesignProblem, deployment: &Deployment) -> f64 {
    let curve = ActuationCurve::new(problem.model.mechanics().unwrap(), deployment).unwrap();
    curve.points.last().unwrap()[1]
}

/// Deploys the start design of a scene with the forces of its law changed by `size` times `errors`
/// in the states of `at`.
fn with_errors(
    scene: &Scene,
    at: &Deployment,
    errors: &[[f64; 3]],
    size: f64,
) -> (DesignProblem, Deployment) {
    let mut problem = scene.problem().unwrap();
    let states = &at.final_step().deformations;
    let designs = at.sheet.designs();
    let corrections = (0..designs.len()).map(|h| {
        let missing =
            MissingForces { state: states[h], forces: errors[h].map(|force| size * force) };
        Correction::new(&designs[h], &[missing])
    });
    let mechanics = mechanics_of(&mut problem.model);
    mechanics.law =
        Arc::new(CorrectedLaw { law: mechanics.law.clone(), corrections: corrections.collect() });
    let deployment = problem.deploy(&scene.start()).unwrap();
    deployment.at_full_load().unwrap();
    (problem, deployment)
}

/// The response to errors of all hinges.
fn response(problem: &DesignProblem, deployment: &Deployment, errors: &[[f64; 3]]) -> SheetChange {
    let mechanics = problem.model.mechanics().unwrap();
    let law = mechanics.law.prepare(&deployment.sheet.designs());
    let hinged = mechanics.hinged(&deployment.sheet, &*law, false);
    let response = ForceResponse::new(&mechanics.solver, hinged, deployment.final_step()).unwrap();
    let errors: Vec<_> = errors.iter().copied().enumerate().collect();
    response.to(&errors).unwrap()
}

/// Orders of the remainders of motions and load. The errors are small: the correction by which the
/// law has them is curved.
fn orders(scene: &Scene) -> [Option<f64>; 2] {
    let problem = scene.problem().unwrap();
    let deployment = problem.deploy(&scene.start()).unwrap();
    let mut random = Random::new(7);
    let errors: Vec<[f64; 3]> = (deployment.sheet.designs().iter())
        .map(|design| [0.02, 0.02, 0.02 * design.w_lig].map(|size| random.number(size)))
        .collect();
    let linear = response(&problem, &deployment, &errors);
    let before = whole_load(&problem, &deployment);
    let remainders = [0.01, 0.005, 0.0025].map(|size| {
        let (problem, changed) = with_errors(scene, &deployment, &errors, size);
        let predicted: Vec<[f64; 3]> =
            std::iter::zip(&deployment.final_step().configuration, &linear.motions)
                .map(|(q, dq)| std::array::from_fn(|d| q[d] + size * dq[d]))
                .collect();
        let motions = difference(&changed.final_step().configuration, &predicted);
        let gained = || whole_load(&problem, &changed) - before;
        let moved = linear.load.map(|by| (gained() - size * by).abs());
        (motions, moved)
    });
    let order = |of: fn(&(f64, Option<f64>)) -> Option<f64>| {
        let [first, second, third] = remainders.each_ref().map(of);
        let (first, second, third) = (first?, second?, third?);
        // A hundred times the residual of the equilibria.
        assert!(third > 1e-10, "rounding: {third:e}");
        Some((first / second).log2().min((second / third).log2()))
    };
    [order(|of| Some(of.0)), order(|of| of.1)]
}

fn undriven(config: &mut SceneConfig) {
    config.drive = None;
    config.loads[0].force = config.loads[0].force.map(|x| 0.2 * x);
}

fn moved_by_a_support(config: &mut SceneConfig) {
    config.drive = None;
    let pulled = config.loads.remove(0);
    config.supports.push(SupportConfig {
        panel: pulled.panel,
        kind: SupportKind::Pin,
        clip: None,
        at: pulled.at,
        displacement: [2.0, -25.0],
        ..config.supports[0]
    });
}

/// Under a prescribed stroke, under dead loads, and if supports move the sheet.
#[test]
fn the_response_is_exact_to_first_order() {
    let driven: fn(&mut SceneConfig) = |_| ();
    let changes = [driven, undriven, moved_by_a_support];
    for (change, has_load) in std::iter::zip(changes, [true, false, true]) {
        let [motions, load] = orders(&film(change));
        assert!(motions.unwrap() >= 1.9, "{motions:?}");
        assert_eq!(load.is_some(), has_load);
        assert!(load.is_none_or(|order| order >= 1.9), "{load:?}");
    }
}

/// All forces stronger by a fraction move no panel under a prescribed stroke, which takes more load
/// by the fraction.
#[test]
fn a_stiffer_law_moves_nothing_under_a_prescribed_stroke() {
    let scene = film(|_| ());
    let problem = scene.problem().unwrap();
    let deployment = problem.deploy(&scene.start()).unwrap();
    let law = problem.model.mechanics().unwrap().law.clone();
    let prepared = law.prepare(&deployment.sheet.designs());
    let states = &deployment.final_step().deformations;
    let energies = prepared.energies(states, Order::Forces);
    let stiffer = (energies.iter()).map(|energy| energy.forces.map(|force| 0.03 * force));
    let stiffer: Vec<[f64; 3]> = stiffer.collect();
    let found = response(&problem, &deployment, &stiffer);
    let flat = vec![[0.0; 3]; found.motions.len()];
    assert!(difference(&found.motions, &flat) < 1e-8, "{found:?}");
    let change = found.load.unwrap() / whole_load(&problem, &deployment);
    assert_close(change, 0.03, 1e-9);
}

/// Under dead loads a law that is stiffer by a fraction is as good as loads that are smaller by it.
#[test]
fn a_stiffer_law_under_dead_loads_is_a_smaller_load() {
    let sheet = sheet_of("p1_3x3_random");
    let law = uniform(SPRINGS, &sheet);
    let prepared = law.prepare(&sheet.designs());
    let hinged = hinged(&sheet, &*prepared);
    let of = |value: f64| solver(sheet.topology.grid, &clamp(3), &[pull(5, value)], 4);
    let end = |value: f64| of(value).path(hinged).pop().unwrap();
    let (size, step) = (1.5, 1e-4);
    let last = end(size);
    let energies = hinged.energies(&last.deformations, Order::Forces);
    let forces = energies.iter().map(|energy| energy.forces);
    let stiffer: Vec<_> = forces.enumerate().collect();
    let solver = of(size);
    let response = ForceResponse::new(&solver, hinged, &last).unwrap();
    let found = response.to(&stiffer).unwrap();
    let [less, more] = [-step, step].map(|change| end(size * (1.0 + change)).configuration);
    let slopes: Vec<[f64; 3]> = std::iter::zip(less, more)
        .map(|(less, more)| std::array::from_fn(|d| (less[d] - more[d]) / (2.0 * step)))
        .collect();
    assert!(difference(&found.motions, &slopes) < 1e-6, "{found:?}");
}
