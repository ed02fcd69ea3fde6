//! Paths corrected from the paths of designs near them are the paths that are followed, or none.

use crate::prelude::*;
use design::equilibrium::warm_start::WarmStart;

/// A random design of a polyester sheet with learned hinges.
fn learned(noise: f64, seed: u64) -> Scene {
    alone("a4-polyester.toml", |config| {
        config.optimiser.start_noise = noise;
        config.optimiser.seed = seed;
    })
}

/// The design with its coordinates changed by `by` at most.
fn moved(design: &DesignVector, by: f64) -> DesignVector {
    let flat = std::iter::zip(design.to_flat(), 1..);
    let flat: Vec<f64> = flat.map(|(x, i)| x + by * f64::from(i).sin()).collect();
    design.with_flat(&flat)
}

/// Evaluations of the design that differs by `by` from a start: followed, and corrected from the
/// path of the start.
fn both(problem: &DesignProblem, start: &DesignVector, by: f64) -> [Evaluation; 2] {
    let known = problem.evaluate(start).unwrap().deployment.warm_start();
    let near = moved(start, by);
    [None, Some(&known)].map(|known| problem.evaluate_near(&near, known).unwrap())
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
        let smooth = steps[0].iter().all(|step| step.jumps == 0);
        assert!(followed.deployment.followed && smooth, "{seed}");
        for (a, b) in std::iter::zip(steps[0], steps[1]) {
            let apart = difference(&a.configuration, &b.configuration);
            assert!(apart < 1e-7, "{seed}: {apart:e} mm");
            assert_eq!(a.status, b.status);
        }
        assert_ratio(corrected.loss, followed.loss, 1e-10);
        let gradients = [&followed, &corrected].map(|evaluation| evaluation.gradient.to_flat());
        let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        let pairs = std::iter::zip(&gradients[0], &gradients[1]);
        let apart: Vec<f64> = pairs.map(|(a, b)| a - b).collect();
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
            let total = |of: fn(&LoadStep) -> usize| deployment.path.iter().map(of).sum::<usize>();
            [total(|step| step.effort.iterations), total(|step| step.effort.factorisations)]
        })
    };
    let [[followed_far, far], [followed, near]] = [0.05, 1e-4].map(effort);
    assert!(near[0] < far[0], "corrections {near:?} {far:?}");
    let factorisations = [near, followed, far, followed_far].map(|effort| effort[1]);
    let [near, followed, far, followed_far] = factorisations;
    assert!(near < followed && far <= followed_far, "{factorisations:?}");
}

#[test]
fn a_path_that_cannot_be_corrected_is_followed() {
    let scene = learned(0.5, 3);
    let problem = scene.problem().unwrap();
    let start = scene.start();
    let known = problem.evaluate(&start).unwrap().deployment.warm_start();
    let followed = |design: &DesignVector, known: &WarmStart| {
        let evaluation = problem.evaluate_near(design, Some(known)).unwrap();
        evaluation.deployment.followed
    };
    assert!(!followed(&moved(&start, 0.01), &known));
    // Another design altogether.
    assert!(followed(&moved(&start, 3.0), &known));
    // A known path that jumps, or ends early.
    let [mut jumps, mut short] = [known.clone(), known];
    jumps.steps[3].jumps = 1;
    short.steps.pop();
    assert!(followed(&start, &jumps) && followed(&start, &short));
}
