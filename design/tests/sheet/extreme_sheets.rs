//! Sheets at the limits of their design space and of their motion.

use crate::extremes::{assert_finite, rotational, snapping};
use crate::prelude::*;
use crate::taylor::{GRID, SIDE, problem, start, tiny};
use std::f64::consts::SQRT_2;

#[test]
fn ten_thousand_panels_find_their_equilibrium() {
    let grid = Grid { m: 100, n: 100 };
    let mut coordinates = PatternCoordinates::uniform(grid);
    coordinates.z = Random::new(29).numbers(coordinates.z.len(), 0.5);
    let outline = Outline::rectangle(100.0, 100.0);
    let sheet = cut(grid, outline, &coordinates, 0.1, AT_CORNER);
    let law = uniform([1e4, 1e4, 1.0], &sheet);
    let path = path(&sheet, &law, &clamp(5000), &[pull(5099, 100.0)], 2);
    assert_finite(&path);
    assert!(converged(&path));
}

/// Cuts that almost collide define a sheet or give an error; the sheet has equilibria or reports
/// that it has not.
#[test]
fn r_and_tau_close_to_their_limits_make_a_sheet_or_an_error() {
    let mut random = Random::new(31);
    let (mut cut, mut refused) = (0, 0);
    for size in [6.0, 12.0, 25.0, 45.0] {
        for (m, n) in [(2, 2), (3, 3), (5, 4)] {
            let grid = Grid { m, n };
            let mut coordinates = PatternCoordinates::uniform(grid);
            let edges = coordinates.ell.iter_mut().flatten();
            let all = coordinates.z.iter_mut().chain(edges);
            all.for_each(|x| *x = size * random.number(1.0).signum() + random.number(0.5));
            let outline = Outline::rectangle(3.0, 2.0);
            let widths = vec![0.01; grid.hinge_count()];
            let pattern = CutPattern::new(grid, outline, &coordinates);
            let sheet = match pattern.and_then(|pattern| Sheet::new(&pattern, &widths, AT_CORNER)) {
                Ok(sheet) => sheet,
                Err(error) => {
                    let message = error.to_string();
                    let collapsed = ["two cuts collide", "its cuts have collapsed"];
                    assert!(collapsed.iter().any(|end| message.ends_with(end)), "{message}");
                    refused += 1;
                    continue;
                }
            };
            let area: f64 = sheet.panels.iter().map(|panel| panel.area).sum();
            assert_ratio(area, outline.area(), 1e-12);
            let law = uniform(SPRINGS, &sheet);
            assert_finite(&path(&sheet, &law, &clamp(0), &[pull(m * n - 1, 0.5)], 3));
            cut += 1;
        }
    }
    assert!(cut > 3 && refused > 3, "{cut} {refused}");
}

/// The opening moments do work on the mechanism alone: through its dead centre at 90 degrees, where
/// a uniform sheet is longest, and beyond, where it becomes shorter again; for any ratio of
/// stiffnesses.
#[test]
fn loads_along_the_mechanism_pass_its_dead_centre() {
    let sheet = sheet_of("p0_3x3_uniform");
    for constants in [[90.0, 40.0, 0.8], [1e6, 1e6, 1e-3]] {
        let (law, theta) = (uniform(constants, &sheet), 2.6);
        let loads = opening_moments(&sheet, 4, constants[2] * theta);
        for step in path(&sheet, &law, &clamp(4), &loads, 13) {
            assert_eq!(step.status, Status::Converged);
            let stretch = apart(&sheet, &step.configuration, [3, 5]) / 2.0;
            let (sin, cos) = (0.5 * step.load_factor * theta).sin_cos();
            assert_close(stretch, cos + sin, 1e-7);
        }
    }
}

/// Beyond lambda_max only the springs deform: the sheet stiffens and remains valid.
#[test]
fn a_sheet_pulled_past_its_maximum_stretch_stiffens() {
    let sheet = sheet_of("p0_3x3_uniform");
    let law = uniform(SPRINGS, &sheet);
    let stroke = 2.0 * (1.25 * SQRT_2 - 1.0);
    let solver = solver(sheet.topology.grid, &clamp(3), &[pull(5, 1.0)], 12);
    let driven = follow(&solver.driven(stroke).unwrap(), &sheet, &law, None);
    assert_finite(&driven);
    assert!(converged(&driven));
    let stiffness = |i: usize| driven[i].load_factor - driven[i - 1].load_factor;
    assert!(stiffness(11) > 4.0 * stiffness(1));
    // The same under load control.
    let load = driven[11].load_factor;
    let loaded = path(&sheet, &law, &clamp(3), &[pull(5, load)], 12);
    assert_finite(&loaded);
    assert_ratio(loaded[11].configuration[5][0], stroke, 1e-7);
}

/// A learned energy loses its digits at small deformations and leaves its domain at large ones:
/// neither leads to a false equilibrium.
#[test]
fn a_learned_sheet_has_a_status_under_loads_of_any_size() {
    let outline = Outline::rectangle(SIDE, SIDE);
    let sheet = cut(GRID, outline, &start().pattern, 16.0, AT_TIP);
    let law = tiny();
    let deployed = |force: f64| path(&sheet, &law, &clamp(3), &[pull(5, force)], 2);
    let compliance = |force: f64| {
        let path = deployed(force);
        // A load that rounding nearly hides leaves a residual above the loose tolerance.
        let loose = SolverSettings::default().loose_tolerance();
        for step in &path {
            let expected = match step.residual <= loose {
                true => Status::Converged,
                false => Status::Almost,
            };
            assert_eq!(step.status, expected, "{force:e}: {}", step.residual);
        }
        assert!(force < 5e-7 || path[1].status == Status::Converged);
        path[1].configuration[5][0] / force
    };
    let expected = compliance(1e-5);
    for (force, error) in [(1e-6, 1e-3), (1e-7, 1e-3), (1e-9, 0.1)] {
        assert_ratio(compliance(force), expected, error);
    }
    for force in [1e6, -1e6] {
        let path = deployed(force);
        assert_finite(&path);
        let last = &path[path.len() - 1];
        assert_ne!(last.status, Status::Converged);
        assert!(last.status == Status::Diverged || last.inside.contains(&false));
    }
}

/// Weights so large that the energy of the flat sheet is not finite: the path has no beginning.
#[test]
fn a_sheet_without_a_finite_energy_has_no_path() {
    let law = rotational(|theta| [f64::INFINITY, theta, 1.0]);
    let sheet = sheet_of("p1_3x3_random");
    let path = path(&sheet, &law, &clamp(3), &[pull(5, 1.0)], 3);
    assert_eq!((path.len(), path[0].status), (1, Status::Diverged));
    assert_finite(&path);
}

/// Beyond the limit point of the load the tangent under displacement control is indefinite; the
/// gradient is exact.
#[test]
fn the_gradient_is_exact_where_the_tangent_is_indefinite() {
    let design = start();
    let driven = |steps: usize, stroke: f64| {
        let mut problem = problem(Model::Ideal { opening: 0.0 }, HingePoint::Corner);
        let (_, sheet) = problem.cut(&design).unwrap();
        let solver = solver(GRID, &clamp(4), &opening_moments(&sheet, 4, 1500.0), steps);
        let law = rotational(|theta| snapping(theta).map(|part| 1500.0 * part));
        problem.model = mechanics(law, solver.driven(stroke).unwrap());
        problem
    };
    let path = driven(60, 0.15).deploy(&design).unwrap().path;
    let smooth = (path.iter()).take_while(|step| step.status == Status::Converged);
    let smooth: Vec<&LoadStep> = smooth.collect();
    let softens = smooth.iter().rposition(|step| step.negative_pivots == 1);
    let steps = 1 + softens.unwrap();
    let problem = driven(steps, 0.15 * steps as f64 / 60.0);
    let evaluation = problem.evaluate(&design).unwrap();
    assert_eq!(evaluation.deployment.final_step().negative_pivots, 1);
    let (x, gradient) = (design.to_flat(), evaluation.gradient.to_flat());
    let direction = Random::new(37).numbers(x.len(), 1.0);
    let loss = |x: &[f64]| problem.loss(&design.with_flat(x));
    let remainders = TaylorRemainders::new(loss, &x, &gradient, &direction, 1e-3, 4).unwrap();
    remainders.assert_orders(1.95..2.05);
}
