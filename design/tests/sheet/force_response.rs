//! The response of an equilibrium to errors of its hinge forces: against equilibria with a law that has them, and in closed form.

use crate::cases::{self, case, difference};
use crate::closed_forms::clamp;
use crate::load_steps::scene;
use crate::random::Random;
use design::analysis::actuation_curve::ActuationCurve;
use design::equilibrium::force_response::{ForceResponse, Response};
use design::equilibrium::hinged_sheet::HingedSheet;
use design::equilibrium::load_step::LoadStep;
use design::equilibrium::settings::SolverSettings;
use design::equilibrium::solver::EquilibriumSolver;
use design::equilibrium::supports::{Dof, Load};
use design::hinge_law::{CorrectedLaw, Correction, LinearLaw, MissingForces};
use design::objective::design_problem::{Deployment, DesignProblem, Mechanics, Model};
use design::scene::{Scene, SceneConfig, SupportConfig, SupportKind};
use std::sync::Arc;

/// The A4 sheet after a change, without its ensemble.
fn film(change: impl Fn(&mut SceneConfig)) -> Scene {
    scene("a4-polyester.toml", |config| {
        if let Some(surrogate) = &mut config.surrogate {
            surrogate.ensemble.clear();
        }
        config.solver.tolerance = 1e-12;
        change(config);
    })
}

fn mechanics(problem: &mut DesignProblem) -> &mut Mechanics {
    match &mut problem.model {
        Model::Equilibrium(mechanics) => mechanics,
        Model::Ideal { .. } => unreachable!("the scene has a hinge law"),
    }
}

fn load(problem: &DesignProblem, deployment: &Deployment) -> f64 {
    let curve = ActuationCurve::new(problem.model.mechanics().unwrap(), deployment).unwrap();
    curve.points.last().unwrap()[1]
}

/// Deploys the start design of a scene with the forces of its law changed by `size` times `errors` in the states of `at`.
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
        let missing = MissingForces {
            state: states[h],
            forces: errors[h].map(|force| size * force),
        };
        Correction::new(&designs[h], &[missing])
    });
    let mechanics = mechanics(&mut problem);
    mechanics.law = Arc::new(CorrectedLaw {
        law: mechanics.law.clone(),
        corrections: corrections.collect(),
    });
    let deployment = problem.deploy(&scene.start()).unwrap();
    deployment.at_full_load().unwrap();
    (problem, deployment)
}

/// The response to errors of all hinges.
fn response(problem: &DesignProblem, deployment: &Deployment, errors: &[[f64; 3]]) -> Response {
    let mechanics = problem.model.mechanics().unwrap();
    let law = mechanics.law.prepare(&deployment.sheet.designs());
    let hinged = mechanics.hinged(&deployment.sheet, &*law, false);
    let response = ForceResponse::new(&mechanics.solver, hinged, deployment.final_step()).unwrap();
    let errors: Vec<_> = errors.iter().copied().enumerate().collect();
    response.to(&errors).unwrap()
}

/// Orders of the remainders of motions and load. The errors are small: the correction by which the law has them is curved.
fn orders(scene: &Scene) -> [Option<f64>; 2] {
    let problem = scene.problem().unwrap();
    let deployment = problem.deploy(&scene.start()).unwrap();
    let mut random = Random::new(7);
    let errors: Vec<[f64; 3]> = (deployment.sheet.designs().iter())
        .map(|design| [0.02, 0.02, 0.02 * design.w_lig].map(|size| random.number(size)))
        .collect();
    let linear = response(&problem, &deployment, &errors);
    let before = load(&problem, &deployment);
    let remainders = [0.01, 0.005, 0.0025].map(|size| {
        let (problem, changed) = with_errors(scene, &deployment, &errors, size);
        let predicted: Vec<[f64; 3]> =
            std::iter::zip(&deployment.final_step().configuration, &linear.motions)
                .map(|(q, dq)| std::array::from_fn(|d| q[d] + size * dq[d]))
                .collect();
        let motions = difference(&changed.final_step().configuration, &predicted);
        let moved = linear
            .load
            .map(|by| (load(&problem, &changed) - before - size * by).abs());
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

#[test]
fn the_response_is_exact_to_first_order_under_a_prescribed_stroke() {
    let [motions, load] = orders(&film(|_| ()));
    assert!(motions.unwrap() >= 1.9, "{motions:?}");
    assert!(load.unwrap() >= 1.9, "{load:?}");
}

#[test]
fn the_response_is_exact_to_first_order_under_dead_loads() {
    let [motions, load] = orders(&film(|config| {
        config.drive = None;
        config.scale_loads(0.2);
    }));
    assert!(motions.unwrap() >= 1.9, "{motions:?}");
    assert_eq!(load, None);
}

#[test]
fn the_response_is_exact_to_first_order_if_supports_move_the_sheet() {
    let [motions, load] = orders(&film(|config| {
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
    }));
    assert!(motions.unwrap() >= 1.9, "{motions:?}");
    assert!(load.unwrap() >= 1.9, "{load:?}");
}

/// All forces stronger by a fraction move no panel under a prescribed stroke, which takes more load by the fraction.
#[test]
fn a_stiffer_law_moves_nothing_under_a_prescribed_stroke() {
    let scene = film(|_| ());
    let problem = scene.problem().unwrap();
    let deployment = problem.deploy(&scene.start()).unwrap();
    let law = problem.model.mechanics().unwrap().law.clone();
    let prepared = law.prepare(&deployment.sheet.designs());
    let states = &deployment.final_step().deformations;
    let energies = prepared.energies(states, design::hinge_law::Order::Forces);
    let stiffer: Vec<[f64; 3]> = (energies.iter())
        .map(|energy| energy.forces.map(|force| 0.03 * force))
        .collect();
    let found = response(&problem, &deployment, &stiffer);
    let flat = vec![[0.0; 3]; found.motions.len()];
    assert!(difference(&found.motions, &flat) < 1e-8, "{found:?}");
    let change = found.load.unwrap() / load(&problem, &deployment);
    assert!((change - 0.03).abs() < 1e-9, "{change}");
}

/// Under dead loads a law that is stiffer by a fraction is as good as loads that are smaller by it.
#[test]
fn a_stiffer_law_under_dead_loads_is_a_smaller_load() {
    let sheet = cases::sheet(&case("p1_3x3_random"));
    let law = LinearLaw::uniform([90.0, 40.0, 0.8], sheet.hinges.len());
    let prepared = design::hinge_law::HingeLaw::prepare(&law, &sheet.designs());
    let hinged = HingedSheet {
        sheet: &sheet,
        law: &*prepared,
        contact: None,
        damage_gradient: false,
    };
    let solver = |value: f64| {
        let pull = Load {
            panel: 5,
            dof: Dof::UX,
            value,
        };
        EquilibriumSolver::new(sheet.grid, &clamp(3), &[pull], 4, SolverSettings::default())
            .unwrap()
    };
    let end = |value: f64| -> LoadStep { solver(value).path(hinged).pop().unwrap() };
    let (size, step) = (1.5, 1e-4);
    let (own, last) = (solver(size), end(size));
    let energies = hinged.energies(&last.deformations, design::hinge_law::Order::Forces);
    let stiffer: Vec<_> = energies
        .iter()
        .map(|energy| energy.forces)
        .enumerate()
        .collect();
    let found = ForceResponse::new(&own, hinged, &last)
        .unwrap()
        .to(&stiffer)
        .unwrap();
    let [less, more] = [-step, step].map(|change| end(size * (1.0 + change)).configuration);
    let slopes: Vec<[f64; 3]> = std::iter::zip(less, more)
        .map(|(less, more)| std::array::from_fn(|d| (less[d] - more[d]) / (2.0 * step)))
        .collect();
    assert!(
        difference(&found.motions, &slopes) < 1e-6,
        "{found:?} {slopes:?}"
    );
}
