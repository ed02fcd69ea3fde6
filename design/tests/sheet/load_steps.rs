//! Final state, jumps and statuses do not depend on the number of load steps.

use crate::extremes::{Uncoupled, assert_finite, rotational, snapping, spring};
use crate::prelude::*;

/// The path of a random linear sheet, with or without contact of its panels.
fn linear(seed: u64, steps: usize) -> Vec<LoadStep> {
    let mut random = Random::new(seed);
    let mut whole = |from: usize, to: usize| {
        from + ((0.5 + 0.5 * random.number(1.0)) * (to - from + 1) as f64) as usize
    };
    let (m, n) = (whole(3, 7), whole(3, 7));
    let grid = Grid { m, n };
    let pulled = grid.panel(m - 1, whole(0, n - 1));
    let contact = whole(0, 1) == 1;
    let mut coordinates = PatternCoordinates::uniform(grid);
    coordinates.z = random.numbers(coordinates.z.len(), 1.0);
    let outline = Outline::rectangle(m as f64, n as f64);
    let sheet = cut(grid, outline, &coordinates, 0.1, AT_CORNER);
    let [k_a, k_s] = [0, 1].map(|_| 10.0_f64.powf(3.0 + random.number(1.0)));
    let loads = [Dof::UX, Dof::UY].map(|dof| load(pulled, dof, random.number(2.0 * n as f64)));
    let solver = solver(grid, &clamp(grid.panel(0, n / 2)), &loads, steps);
    let contact = contact.then_some(Contact::new(1.0, -0.1, -0.01).unwrap());
    follow(&solver, &sheet, &uniform([k_a, k_s, 1.0], &sheet), contact.as_ref())
}

/// The path of a random design of the polyester sheet with learned hinges.
fn learned(seed: u64, steps: usize) -> Vec<LoadStep> {
    let scene = alone("pet-3x3.toml", |config| {
        config.load_steps = steps;
        config.optimiser.start_noise = 1.2;
        config.optimiser.seed = seed;
        config.objective.domain = 0.0;
    });
    let problem = scene.problem().unwrap();
    problem.deploy(&scene.start()).unwrap().path
}

/// Fails if the paths with the given numbers of load steps differ.
fn assert_equal_paths(name: &str, steps: &[usize], path: impl Fn(usize) -> Vec<LoadStep>) {
    let jumps = |path: &[LoadStep]| path.iter().map(|step| step.jumps).sum::<usize>();
    let reference = path(steps[0]);
    let (end, expected) = (&reference[reference.len() - 1], jumps(&reference));
    for &steps in &steps[1..] {
        let path = path(steps);
        assert_finite(&path);
        let last = &path[path.len() - 1];
        let at = format!("{name}, {steps} steps");
        assert_eq!(jumps(&path), expected, "{at}");
        let ended = |step: &LoadStep| step.status == Status::Diverged;
        assert_eq!(ended(last), ended(end), "{at}");
        let apart = difference(&last.configuration, &end.configuration);
        let size = last.configuration.as_flattened().iter();
        let size = size.fold(1.0_f64, |most, q| most.max(q.abs()));
        assert!(apart < 1e-7 * size, "{at}: {apart:e}");
        let energy = last.potential / end.potential - 1.0;
        assert!(energy.abs() < 1e-9, "{at}: {energy:e}");
        for step in &path {
            let jumped = matches!(step.status, Status::LimitPoint | Status::Almost);
            let silent = step.jumps > 0 && !jumped && !ended(step);
            assert!(!silent, "{at}: a silent jump");
        }
    }
}

#[test]
fn paths_do_not_depend_on_the_number_of_load_steps() {
    let mut jumping = 0;
    for seed in (0..40).chain(100..350) {
        let path = |steps| linear(seed, steps);
        assert_equal_paths(&format!("linear {seed}"), &[5, 10, 20, 100], path);
        jumping += usize::from(path(5).iter().any(|step| step.jumps > 0));
    }
    for seed in [3].into_iter().chain(100..110) {
        assert_equal_paths(&format!("linear {seed}"), &[5, 1000], |steps| linear(seed, steps));
    }
    assert!(jumping > 10, "{jumping} of 290 paths jump");
}

#[test]
fn paths_of_learned_sheets_do_not_depend_on_the_number_of_load_steps() {
    for seed in (0..6).chain(100..120) {
        let path = |steps| learned(seed, steps);
        assert_equal_paths(&format!("learned {seed}"), &[5, 20, 100], path);
    }
}

/// k_a a^2/2 + k_theta theta^2/2 and a double well in s: a hinge that snaps by 0.3 in shear turns
/// its panels little.
fn snapping_in_shear() -> impl HingeLaw {
    Uncoupled(|eps: HingeDeformation| {
        let [well, force, stiffness] = snapping(eps.s / 0.3);
        let well = [well, force / 0.3, stiffness / 0.09];
        [spring(100.0, eps.a), well, spring(1000.0, eps.theta)]
    })
}

#[test]
fn a_snap_in_shear_is_reported() {
    let sheet = sheet_of("p0_3x3_uniform");
    let snaps = |steps: usize| {
        let law = snapping_in_shear();
        let path = path(&sheet, &law, &clamp(3), &[pull(5, 25.0)], steps);
        assert_finite(&path);
        path
    };
    let coarse = snaps(4);
    assert!(coarse.iter().any(|step| step.status == Status::LimitPoint));
    let turns = coarse[3].configuration.iter().map(|q| q[2].abs());
    assert!(turns.fold(0.0, f64::max) < 0.1);
    assert_equal_paths("shear", &[4, 5, 40, 200], snaps);
}

/// Hinges a hundred times softer in rotation than the hinges of the scene: the flat sheet turns by
/// most of its opening at a hundredth of the load.
#[test]
fn soft_hinges_have_an_equilibrium_at_full_load() {
    for k_theta in [10.0, 1.0] {
        let scene = scene("linear-7x7.toml", |config| {
            config.linear.as_mut().unwrap().k_theta = k_theta;
        });
        let deployment = scene.problem().unwrap().deploy(&scene.start()).unwrap();
        assert_finite(&deployment.path);
        let last = deployment.at_full_load().unwrap();
        assert!(last.residual <= last.rounding.max(1e-10) && last.negative_pivots == 0);
    }
}

/// Forces with seven digits: the sheet jumps, and lands at a residual above or below the tolerance.
#[test]
fn a_jump_does_not_hide_an_unconverged_state() {
    let law = rotational(|theta| {
        let [energy, moment, stiffness] = snapping(theta);
        [energy, (moment * 3e6).round() / 3e6, stiffness]
    });
    let sheet = sheet_of("p1_3x3_random");
    let mut unconverged = 0;
    for m_theta in [0.29, 0.3, 0.31, 0.32, 0.33] {
        let loads = opening_moments(&sheet, 4, m_theta);
        let path = path(&sheet, &law, &clamp(4), &loads, 3);
        let landed = path.iter().find(|step| step.jumps > 0).unwrap();
        let expected = match landed.residual <= landed.rounding.max(1e-10) {
            true => Status::LimitPoint,
            false => Status::Almost,
        };
        assert_eq!(landed.status, expected, "{m_theta}");
        unconverged += usize::from(expected == Status::Almost);
    }
    assert!(unconverged > 0);
}

/// Fails if a path took more corrections, factorisations or rejected increments.
fn assert_costs_at_most(most: [usize; 3], path: &[LoadStep]) {
    let total = |of: fn(&LoadStep) -> usize| path.iter().map(of).sum::<usize>();
    let found = [
        total(|step| step.effort.iterations),
        total(|step| step.effort.factorisations),
        total(|step| step.effort.rejected),
    ];
    let within = std::iter::zip(found, most).all(|(found, most)| found <= most);
    assert!(within, "{found:?} {most:?}");
}

/// The cost of three paths without jumps, so that a change of it is noticed: of linear hinges, with
/// contact, learned.
#[test]
fn a_path_costs_a_bounded_number_of_factorisations() {
    let sheet = sheet_of("p2_4x7_random");
    let law = uniform([1000.0, 1000.0, 0.1], &sheet);
    let pull = [pull(15, 2.0)];
    let path = path(&sheet, &law, &clamp(12), &pull, 10);
    assert!(converged(&path));
    assert_costs_at_most([80, 36, 3], &path);

    // The contact begins at -0.01 rad and becomes rigid at -0.1 rad.
    let path = linear(2, 10);
    let touches = |step: &LoadStep| step.deformations.iter().any(|eps| eps.theta < -0.09);
    assert!(path.iter().any(touches) && path.iter().all(|step| step.jumps == 0));
    assert_costs_at_most([110, 44, 3], &path);

    let path = learned(150, 20);
    assert!(converged(&path));
    assert_costs_at_most([220, 90, 7], &path);
}
