//! The equilibrium at full load as a function: its gradient in every input by Taylor remainders,
//! balance of loads, reactions and weight, and inputs that are refused.

use crate::prelude::*;
use design::equilibrium::load_step::DescentEnd;
use design::objective::response::{Conditions, Response, ResponseCotangent};
use std::sync::atomic::{AtomicBool, Ordering};

/// Dead loads on a clamped film; a hanging plate, heavy and with a prescribed stroke; springs.
const SCENES: [&str; 3] = ["pet-3x3", "a4-plate", "linear-7x7"];

fn problem(scene: &str) -> (DesignProblem, DesignVector) {
    let scene = crate::prelude::scene(&format!("{scene}.toml"), |_| ());
    (scene.problem().unwrap(), scene.start())
}

fn loads(problem: &DesignProblem) -> Vec<[f64; 3]> {
    problem.model.mechanics().unwrap().solver.loads().to_vec()
}

fn loaded(loads: Vec<[f64; 3]>) -> Conditions {
    Conditions { loads: Some(loads), ..Conditions::default() }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}

/// A vector with entries of order one that has no symmetry.
fn wave(length: usize, phase: f64) -> Vec<f64> {
    let entries = (0..length).map(|i| (1.7 * i as f64 + phase).sin());
    entries.collect()
}

fn triples(values: &[f64]) -> Vec<[f64; 3]> {
    values.as_chunks().0.to_vec()
}

/// A function of the outputs: linear in forces and the load factor, quadratic in the corners.
fn value(response: &Response) -> f64 {
    let by = cotangent(response);
    let by_corners = by.corners.as_flattened().as_flattened();
    let corners = response.corners();
    let reactions = response.reactions.as_flattened();
    0.5 * dot(by_corners, corners.as_flattened().as_flattened())
        + dot(by.reactions.as_flattened(), reactions)
        + by.load_factor * response.state().load_factor
}

fn cotangent(response: &Response) -> ResponseCotangent {
    let mut corners = response.corners();
    let weights = wave(corners.as_flattened().len(), 0.3);
    for (corner, weight) in corners.as_flattened_mut().iter_mut().zip(weights) {
        *corner = corner.map(|x| 1e-3 * weight * x);
    }
    ResponseCotangent {
        corners,
        reactions: triples(&wave(3 * response.reactions.len(), 0.7)),
        load_factor: 2.0,
    }
}

/// Entries: design, loads at free degrees of freedom, logarithms of thickness and stresses.
struct Inputs {
    design: DesignVector,
    conditions: Conditions,
}

impl Inputs {
    fn at(design: &DesignVector, loads: &[[f64; 3]], free: &[[f64; 3]], x: &[f64]) -> Self {
        let start = design.to_flat();
        let (by_design, rest) = x.split_at(start.len());
        let (by_loads, by_logarithms) = rest.split_at(3 * loads.len());
        let moved = std::iter::zip(start, by_design).map(|(x, d)| x + d);
        let loads: Vec<f64> = (loads.as_flattened().iter())
            .zip(by_loads)
            .zip(free.as_flattened())
            .map(|((load, d), free)| load + free * d)
            .collect();
        Self {
            design: design.with_flat(&moved.collect::<Vec<_>>()),
            conditions: Conditions {
                loads: Some(triples(&loads)),
                thickness: by_logarithms[0].exp(),
                stress: by_logarithms[1].exp(),
            },
        }
    }
}

#[test]
fn the_gradient_in_every_input() {
    for scene in SCENES {
        let (problem, design) = problem(scene);
        let loads = loads(&problem);
        let response = problem.response(&design, None).unwrap();
        assert!(response.deployment.followed);
        let by = cotangent(&response);
        let found = problem.response_pullback(&design, &response, &by).unwrap();
        let known = response.deployment.warm_start();
        // 1 where the response is a differentiable function of the load.
        let driven = problem.model.mechanics().unwrap().solver.is_driven();
        let variable = |panel: usize, d: usize| {
            let mut with = vec![[0.0; 3]; loads.len()];
            with[panel][d] = 1.0;
            let kink = driven && d < 2 && loads[panel][..2] == [0.0; 2];
            problem.under(&loaded(with)).is_ok() && !kink
        };
        let of_panel = |panel| [0, 1, 2].map(|d| f64::from(variable(panel, d)));
        let free: Vec<[f64; 3]> = (0..loads.len()).map(of_panel).collect();
        let variables = design.to_flat().len();
        let mut gradient = found.design.to_flat();
        gradient.extend(found.loads.as_flattened());
        gradient.extend([found.thickness.unwrap_or(0.0), found.stress.unwrap()]);
        let load = largest(loads.as_flattened());
        let blocks = [
            ("design", 0..variables, 1.0),
            ("loads", variables..gradient.len() - 2, load),
            // The response is smooth enough for steps that lift the remainders above rounding.
            ("thickness", gradient.len() - 2..gradient.len() - 1, 5.0),
            ("stresses", gradient.len() - 1..gradient.len(), 5.0),
        ];
        for (block, range, size) in blocks {
            if block == "thickness" && found.thickness.is_none() {
                continue;
            }
            let mut direction = vec![0.0; gradient.len()];
            let entries = wave(range.len(), 0.5).into_iter().map(|x| size * x);
            direction.splice(range, entries);
            let free = free.as_flattened();
            for (entry, free) in direction[variables..].iter_mut().zip(free) {
                *entry *= free;
            }
            let free = triples(free);
            let at = |x: &[f64]| -> Result<f64, DesignError> {
                let inputs = Inputs::at(&design, &loads, &free, x);
                let problem = problem.under(&inputs.conditions)?;
                let response = problem.response(&inputs.design, Some(&known))?;
                Ok(value(&response))
            };
            let flat = vec![0.0; gradient.len()];
            let taylor = TaylorRemainders::new(at, &flat, &gradient, &direction, 4e-3, 4).unwrap();
            taylor.assert_orders(1.9..2.3);
        }
    }
}

/// The state that is known gives the same outputs and the same gradient without a path.
#[test]
fn a_known_configuration_gives_the_same_response() {
    for scene in SCENES {
        let (problem, design) = problem(scene);
        let response = problem.response(&design, None).unwrap();
        let path = problem.deploy(&design).unwrap().warm_start();
        assert!(!problem.response(&design, Some(&path)).unwrap().deployment.followed);
        let configuration = &response.state().configuration;
        let again = problem.response_at(&design, configuration).unwrap();
        assert_eq!(again.corners(), response.corners());
        assert_eq!(again.reactions, response.reactions);
        let by = cotangent(&response);
        let [first, second] = [&response, &again].map(|response| {
            let gradient = problem.response_pullback(&design, response, &by).unwrap();
            gradient.design.to_flat()
        });
        let size = largest(&first);
        for (first, second) in std::iter::zip(first, second) {
            assert_close(first, second, 1e-8 * size);
        }
        let mut elsewhere = configuration.clone();
        elsewhere[4][2] += 0.1;
        let refused = problem.response_at(&design, &elsewhere);
        assert!(matches!(refused, Err(DesignError::NoEquilibrium { .. })));
    }
}

#[test]
fn a_draft_is_the_equilibrium_that_a_path_leads_to_where_there_is_one() {
    for scene in SCENES {
        let (problem, design) = problem(scene);
        let known = problem.deploy(&design).unwrap().warm_start();
        // Beyond the distance at which a path is corrected from a known one, but without a jump.
        let mut wider = design.clone();
        wider.omega.iter_mut().for_each(|omega| *omega += 0.3);
        let draft = problem.draft(&wider, Some(&known)).unwrap();
        let followed = problem.draft(&wider, None).unwrap();
        assert!(!draft.deployment.followed && followed.deployment.followed);
        let size = problem.outline.corners[2][0];
        let [draft, followed] = [draft, followed].map(|it| it.corners());
        for (draft, followed) in std::iter::zip(draft.as_flattened(), followed.as_flattened()) {
            let apart = (draft[0] - followed[0]).hypot(draft[1] - followed[1]);
            assert!(apart < 1e-6 * size, "{scene}: {apart} mm");
        }
    }
}

#[test]
fn a_stopped_path_has_no_equilibrium_at_full_load() {
    let (mut problem, design) = problem("pet-3x3");
    let stop = Arc::new(AtomicBool::new(true));
    problem.stop_by(Arc::clone(&stop));
    let stopped = problem.deploy(&design).unwrap();
    assert_eq!(stopped.final_step().descent_end, Some(DescentEnd::Stopped));
    let error = problem.evaluate(&design).err().unwrap().to_string();
    assert!(error.contains("stopped on request"), "{error}");
    stop.store(false, Ordering::Relaxed);
    assert!(problem.evaluate(&design).is_ok());
}

#[test]
fn reactions_balance_loads_and_weight() {
    for scene in SCENES {
        let (problem, design) = problem(scene);
        let response = problem.response(&design, None).unwrap();
        let state = response.state();
        let weight = problem.model.mechanics().unwrap().solver.weight();
        let panels = &response.deployment.sheet.panels;
        let area: f64 = panels.iter().map(|panel| panel.area).sum();
        for d in 0..2 {
            let load: f64 = loads(&problem).iter().map(|load| load[d]).sum();
            let reaction: f64 = response.reactions.iter().map(|reaction| reaction[d]).sum();
            let sum = state.load_factor * load + weight[d] * area + reaction;
            assert_close(sum, 0.0, 1e-6 * (1.0 + reaction.abs()));
        }
        // The path of the command line ends in the same state.
        let path = problem.deploy(&design).unwrap();
        assert_ne!(path.final_step().status, Status::Diverged);
        let of_path = &path.final_step().configuration;
        assert!(difference(&state.configuration, of_path) < 1e-6, "{scene}");
    }
}

#[test]
fn what_no_response_is_known_for_is_refused() {
    let under = |thickness: f64, stress: f64| Conditions { loads: None, thickness, stress };
    let (springs, _) = problem("linear-7x7");
    let refused = |result: Result<DesignProblem, DesignError>, message: &str| {
        let error = result.err().unwrap().to_string();
        assert!(error.starts_with(message), "{error}");
    };
    refused(springs.under(&under(1.1, 1.0)), "the hinge law does not determine the hinges");
    let (film, design) = problem("pet-3x3");
    for (thickness, stress) in [(0.0, 1.0), (1.0, -1.0), (f64::NAN, 1.0), (1.0, f64::INFINITY)] {
        let result = film.under(&under(thickness, stress));
        refused(result, "a sheet with these errors cannot exist");
    }
    let mut on_clamp = loads(&film);
    on_clamp[3][0] = 1.0;
    refused(film.under(&loaded(on_clamp)), "panel 3 is loaded in UX, where it is supported");
    let pins = problem("pin-7x7").0.under(&Conditions::default());
    refused(pins, "the level `pin` has no equilibrium");
    assert!(problem("pin-7x7").0.response(&design, None).is_err());
}
