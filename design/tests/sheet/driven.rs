//! Displacement control: the same equilibria as under load control, and those beyond a limit point.

use crate::extremes::{rotational, snapping};
use crate::prelude::*;

fn driven(
    sheet: &Sheet,
    law: &dyn HingeLaw,
    (supports, loads): (&[Support], &[Load]),
    steps: usize,
    stroke: f64,
) -> Vec<LoadStep> {
    let solver = solver(sheet.topology.grid, supports, loads, steps);
    follow(&solver.driven(stroke).unwrap(), sheet, law, None)
}

/// The sum of all couples.
fn couples(loads: &[Load]) -> f64 {
    loads.iter().map(|load| load.value.abs()).sum()
}

fn work(loads: &[Load], step: &LoadStep) -> f64 {
    let moved = |load: &Load| step.configuration[load.panel][load.dof.index()];
    loads.iter().map(|load| load.value * moved(load)).sum()
}

#[test]
fn the_stroke_of_a_load_reproduces_the_load() {
    let sheet = sheet_of("p1_3x3_random");
    let law = uniform(SPRINGS, &sheet);
    let several = vec![pull(5, 0.8), load(5, Dof::UY, 0.3), load(7, Dof::Phi, 0.2)];
    let opening = opening_moments(&sheet, 3, 0.5);
    let sum = couples(&opening);
    // If there are forces, a couple does not count.
    let (one, both) = (vec![pull(5, 1.5)], f64::hypot(0.8, 0.3));
    for (loads, size) in [(one, 1.5), (several, both), (opening, sum)] {
        let end = path(&sheet, &law, &clamp(3), &loads, 4).pop().unwrap();
        let stroke = work(&loads, &end) / size;
        let last = &driven(&sheet, &law, (&clamp(3), &loads), 3, stroke)[2];
        assert_eq!(last.status, Status::Converged);
        assert_close(last.load_factor, 1.0, 1e-8);
        assert!(difference(&last.configuration, &end.configuration) < 1e-8);
        assert_close(last.potential, end.potential, 1e-9);
    }
}

/// dP/d(stroke) by central differences of the whole load P.
#[test]
fn the_stiffness_is_the_slope_of_the_load_over_its_stroke() {
    let sheet = sheet_of("p1_3x3_random");
    let law = uniform(SPRINGS, &sheet);
    let several = vec![pull(5, 0.8), load(5, Dof::UY, 0.6), load(7, Dof::Phi, 0.2)];
    let couple = vec![load(5, Dof::Phi, -0.4)];
    for (loads, size) in [(vec![pull(5, 1.5)], 1.5), (several, 1.0), (couple, 0.4)] {
        let stroke = |factor: f64| {
            let scaled = |it: &Load| load(it.panel, it.dof, factor * it.value);
            let scaled: Vec<Load> = loads.iter().map(scaled).collect();
            work(&loads, &path(&sheet, &law, &clamp(3), &scaled, 4)[3]) / size
        };
        let step = 1e-3;
        let slope = 2.0 * step * size / (stroke(1.0 + step) - stroke(1.0 - step));
        let solver = solver(sheet.topology.grid, &clamp(3), &loads, 4);
        let path = follow(&solver, &sheet, &law, None);
        assert_ratio(path[3].stiffness(&solver).unwrap(), slope, 1e-5);
    }
}

/// Hinges of W = theta^2 (theta - 1)^2 soften beyond 0.21 rad, one after the other. Under
/// displacement control the path is followed where the load decreases, and the stored energy equals
/// the work of the loads. At 97 % of the stroke a hinge snaps by 0.14 rad although the stroke is
/// prescribed, and 1.2e-3 N mm are lost.
#[test]
fn a_snapping_sheet_is_followed_beyond_its_maximum_load() {
    let sheet = sheet_of("p1_3x3_random");
    let loads = opening_moments(&sheet, 4, 1.0);
    let couples = couples(&loads);
    let (steps, stroke) = (60, 0.15);
    let (law, held) = (rotational(snapping), clamp(4));
    let path = driven(&sheet, &law, (&held, &loads), steps, stroke);
    assert_eq!(path.len(), steps);
    let (mut worked, mut before, mut fell) = (0.0, 0.0, 0);
    for step in &path {
        assert!(step.status == Status::Converged || step.jumps > 0, "{step}");
        worked += 0.5 * (before + step.load_factor) * couples * stroke / steps as f64;
        fell += usize::from(step.load_factor < before && step.negative_pivots == 1);
        before = step.load_factor;
        let stored: f64 = step.energies.iter().sum();
        assert_close(worked, stored, 2e-3);
    }
    assert!(fell > 5, "{fell}");
    let jumps: Vec<usize> = (0..steps).filter(|&i| path[i].jumps > 0).collect();
    assert_eq!(jumps, [58]);
}

/// A spring of 1 N mm/rad with a bump: its moment has maxima of 0.218 and 0.406 N mm. At both loads
/// the sheet jumps, by less than 0.1 rad.
#[test]
fn small_jumps_are_reported() {
    fn bumpy(theta: f64) -> [f64; 3] {
        let (size, width) = (0.03, 0.03);
        let x = (theta - 0.3) / width;
        let (sin, cos) = x.sin_cos();
        let inside = x.abs() < std::f64::consts::PI;
        let bump = |value: f64| if inside { value } else { 0.0 };
        [
            0.5 * theta * theta + bump(-size * width * (1.0 + cos).powi(2)),
            theta + bump(2.0 * size * (1.0 + cos) * sin),
            1.0 + bump(2.0 * size / width * ((1.0 + cos) * cos - sin * sin)),
        ]
    }
    let sheet = sheet_of("p1_3x3_random");
    let loads = opening_moments(&sheet, 4, 0.6);
    let path = path(&sheet, &rotational(bumpy), &clamp(4), &loads, 6);
    let jumps: Vec<usize> = path.iter().map(|step| step.jumps).collect();
    assert_eq!(jumps, [0, 0, 1, 0, 1, 0]);
    let jumped = |step: &&LoadStep| step.status == Status::LimitPoint;
    assert_eq!(path.iter().filter(jumped).count(), 2);
    assert!(path.iter().all(|step| step.residual <= 1e-10));
}
