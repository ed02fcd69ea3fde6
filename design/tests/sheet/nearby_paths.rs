//! Paths corrected from those of designs near them are the paths that are followed, or none.

use crate::cases::difference;
use crate::load_steps::scene;
use design::equilibrium::load_step::LoadStep;
use design::objective::design_problem::{DesignProblem, Evaluation};
use design::pattern::design_vector::DesignVector;
use design::scene::Scene;

/// A random design of a polyester sheet with learned hinges.
fn learned(noise: f64, seed: u64) -> Scene {
    scene("a4-polyester.toml", |config| {
        config.optimiser.start_noise = noise;
        config.optimiser.seed = seed;
        if let Some(surrogate) = &mut config.surrogate {
            surrogate.ensemble.clear();
        }
    })
}

/// The design with its coordinates changed by `by` at most.
fn beside(design: &DesignVector, by: f64) -> DesignVector {
    let flat = std::iter::zip(design.to_flat(), 1..);
    let flat: Vec<f64> = flat.map(|(x, i)| x + by * f64::from(i).sin()).collect();
    design.with_flat(&flat)
}

/// Evaluations of the design `by` beside a start: followed, and corrected from the path of the start.
fn both(problem: &DesignProblem, start: &DesignVector, by: f64) -> [Evaluation; 2] {
    let known = problem.evaluate(start).unwrap().deployment.known_path();
    let near = beside(start, by);
    [None, Some(&known)].map(|known| problem.evaluate_near(&near, known).unwrap())
}

fn smooth(path: &[LoadStep]) -> bool {
    path.iter().all(|step| step.jumps == 0)
}

#[test]
fn a_corrected_path_is_the_followed_path() {
    let mut compared = 0;
    for seed in 0..12 {
        let scene = learned(0.3, seed);
        let problem = scene.problem().unwrap();
        let [followed, corrected] = both(&problem, &scene.start(), 0.02);
        let steps = [&followed, &corrected].map(|evaluation| &evaluation.deployment.path);
        if corrected.deployment.followed {
            continue;
        }
        compared += 1;
        assert!(followed.deployment.followed && smooth(steps[0]), "{seed}");
        for (a, b) in std::iter::zip(steps[0], steps[1]) {
            let apart = difference(&a.configuration, &b.configuration);
            assert!(apart < 1e-7, "{seed}: {apart:e} mm");
            assert_eq!(a.status, b.status);
        }
        let loss = corrected.loss / followed.loss - 1.0;
        assert!(loss.abs() < 1e-10, "{seed}: {loss:e}");
        let gradients = [&followed, &corrected].map(|evaluation| evaluation.gradient.to_flat());
        let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        let apart: Vec<f64> = std::iter::zip(&gradients[0], &gradients[1])
            .map(|(a, b)| a - b)
            .collect();
        assert!(norm(&apart) < 1e-7 * norm(&gradients[0]), "{seed}");
    }
    assert!(compared >= 6, "{compared} corrected paths");
}

/// The linearised law predicts a state to second order in the change of the design.
#[test]
fn the_effort_falls_with_the_change_of_the_design() {
    let scene = learned(0.5, 3);
    let problem = scene.problem().unwrap();
    let effort = |by: f64| {
        let paths = both(&problem, &scene.start(), by).map(|evaluation| evaluation.deployment);
        assert!(!paths[1].followed, "{by}");
        paths.map(|deployment| {
            let efforts = deployment.path.iter().map(|step| step.effort);
            efforts.fold([0; 2], |[iterations, factorisations], effort| {
                [
                    iterations + effort.iterations,
                    factorisations + effort.factorisations,
                ]
            })
        })
    };
    let [followed, far] = effort(0.05);
    let [_, near] = effort(1e-4);
    assert!(near[0] < far[0], "corrections {near:?} {far:?}");
    assert!(far[1] < followed[1], "factorisations {far:?} {followed:?}");
}

#[test]
fn a_path_that_cannot_be_corrected_is_followed() {
    let scene = learned(0.5, 3);
    let problem = scene.problem().unwrap();
    let start = scene.start();
    let known = problem.evaluate(&start).unwrap().deployment.known_path();
    let followed = |problem: &DesignProblem, design: &DesignVector| {
        let evaluation = problem.evaluate_near(design, Some(&known)).unwrap();
        evaluation.deployment.followed
    };
    assert!(!followed(&problem, &beside(&start, 0.01)));
    // Another design altogether.
    assert!(followed(&problem, &beside(&start, 3.0)));
    // A known path that jumps, or ends early.
    let mut jumps = known.clone();
    jumps.steps[3].jumps = 1;
    let mut short = known.clone();
    short.steps.pop();
    for known in [jumps, short] {
        let evaluation = problem.evaluate_near(&start, Some(&known)).unwrap();
        assert!(evaluation.deployment.followed);
    }
}
