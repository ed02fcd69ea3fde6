//! Displacement control: the same equilibria as under load control, and those beyond a limit point.

use crate::cases::{self, case, difference};
use crate::closed_forms::{clamp, opening_moments, path};
use crate::extremes::{Rotational, snapping};
use design::equilibrium::hinged_sheet::HingedSheet;
use design::equilibrium::load_step::{LoadStep, Status};
use design::equilibrium::settings::SolverSettings;
use design::equilibrium::solver::EquilibriumSolver;
use design::equilibrium::supports::{Dof, Load, Support};
use design::hinge_law::{HingeLaw, LinearLaw};
use design::sheet::cut_sheet::Sheet;

fn driven(
    sheet: &Sheet,
    law: &dyn HingeLaw,
    (supports, loads): (&[Support], &[Load]),
    steps: usize,
    stroke: f64,
) -> Vec<LoadStep> {
    let settings = SolverSettings::default();
    let solver = EquilibriumSolver::new(sheet.grid, supports, loads, steps, settings).unwrap();
    let law = law.prepare(&sheet.designs());
    solver.driven(stroke).unwrap().path(HingedSheet {
        sheet,
        law: &*law,
        contact: None,
        damage_gradient: true,
    })
}

#[test]
fn the_stroke_of_a_load_reproduces_the_load() {
    let sheet = cases::sheet(&case("p1_3x3_random"));
    let law = LinearLaw::uniform([90.0, 40.0, 0.8], 12);
    let load = |panel, dof, value| Load { panel, dof, value };
    for loads in [
        vec![load(5, Dof::UX, 1.5)],
        vec![
            load(5, Dof::UX, 0.8),
            load(5, Dof::UY, 0.3),
            load(7, Dof::Phi, 0.2),
        ],
        opening_moments(&sheet, 3, 0.5),
    ] {
        let loaded = path(&sheet, &law, &clamp(3), &loads, 4);
        let end = &loaded[3];
        let work: f64 = loads
            .iter()
            .map(|load| load.value * end.configuration[load.panel][load.dof as usize])
            .sum();
        let force = |panel| {
            let of = |dof| {
                let found = loads
                    .iter()
                    .find(|load| load.panel == panel && load.dof == dof);
                found.map_or(0.0, |load| load.value)
            };
            f64::hypot(of(Dof::UX), of(Dof::UY))
        };
        let forces: f64 = (0..9).map(force).sum();
        let couples: f64 = loads.iter().map(|load| load.value.abs()).sum();
        let stroke = work / if forces > 0.0 { forces } else { couples };
        let path = driven(&sheet, &law, (&clamp(3), &loads), 3, stroke);
        let last = &path[2];
        assert_eq!(last.status, Status::Converged);
        assert!(
            (last.load_factor - 1.0).abs() < 1e-8,
            "{}",
            last.load_factor
        );
        assert!(difference(&last.configuration, &end.configuration) < 1e-8);
        assert!((last.potential - end.potential).abs() < 1e-9);
    }
}

/// dP/d(stroke) by central differences of the whole load P.
#[test]
fn the_stiffness_is_the_slope_of_the_load_over_its_stroke() {
    let sheet = cases::sheet(&case("p1_3x3_random"));
    let law = LinearLaw::uniform([90.0, 40.0, 0.8], 12);
    let load = |panel, dof, value| Load { panel, dof, value };
    for (loads, size) in [
        (vec![load(5, Dof::UX, 1.5)], 1.5),
        (
            vec![
                load(5, Dof::UX, 0.8),
                load(5, Dof::UY, 0.6),
                load(7, Dof::Phi, 0.2),
            ],
            1.0,
        ),
        (vec![load(5, Dof::Phi, -0.4)], 0.4),
    ] {
        let stroke = |factor: f64| {
            let scaled: Vec<Load> = (loads.iter())
                .map(|load| Load {
                    value: factor * load.value,
                    ..*load
                })
                .collect();
            let end = path(&sheet, &law, &clamp(3), &scaled, 4);
            let moved = |load: &Load| end[3].configuration[load.panel][load.dof.index()];
            let work: f64 = loads.iter().map(|load| load.value * moved(load)).sum();
            work / size
        };
        let step = 1e-3;
        let slope = 2.0 * step * size / (stroke(1.0 + step) - stroke(1.0 - step));
        let settings = SolverSettings::default();
        let solver = EquilibriumSolver::new(sheet.grid, &clamp(3), &loads, 4, settings).unwrap();
        let prepared = law.prepare(&sheet.designs());
        let path = solver.path(HingedSheet {
            sheet: &sheet,
            law: &*prepared,
            contact: None,
            damage_gradient: false,
        });
        let stiffness = path[3].stiffness(&solver).unwrap();
        assert!(
            (stiffness / slope - 1.0).abs() < 1e-5,
            "{stiffness} {slope}"
        );
    }
}

/// Hinges of W = theta^2 (theta - 1)^2 soften beyond 0.21 rad, one after the other. Under displacement control the
/// path is followed where the load decreases, and the stored energy equals the work of the loads. At 97 % of the stroke
/// a hinge snaps by 0.14 rad although the stroke is prescribed, and 1.2e-3 N mm are lost.
#[test]
fn a_snapping_sheet_is_followed_beyond_its_maximum_load() {
    let sheet = cases::sheet(&case("p1_3x3_random"));
    let loads = opening_moments(&sheet, 4, 1.0);
    let couples: f64 = loads.iter().map(|load| load.value.abs()).sum();
    let (steps, stroke) = (60, 0.15);
    let path = driven(
        &sheet,
        &Rotational(snapping),
        (&clamp(4), &loads),
        steps,
        stroke,
    );
    assert_eq!(path.len(), steps);
    let (mut worked, mut before, mut fell) = (0.0, 0.0, 0);
    for step in &path {
        let found = (step.residual, step.negative_pivots, step.load_factor);
        assert!(
            step.status == Status::Converged || step.jumps > 0,
            "{found:?}"
        );
        worked += 0.5 * (before + step.load_factor) * couples * stroke / steps as f64;
        fell += usize::from(step.load_factor < before && step.negative_pivots == 1);
        before = step.load_factor;
        let stored: f64 = step.energies.iter().sum();
        assert!((worked - stored).abs() < 2e-3, "{worked} {stored}");
    }
    assert!(fell > 5, "{fell}");
    let jumps: Vec<usize> = (0..steps).filter(|&i| path[i].jumps > 0).collect();
    assert_eq!(jumps, [58]);
}

/// A spring of 1 N mm/rad with a bump: its moment has maxima of 0.218 and 0.406 N mm. At both loads the sheet jumps, by
/// less than 0.1 rad.
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
    let sheet = cases::sheet(&case("p1_3x3_random"));
    let loads = opening_moments(&sheet, 4, 0.6);
    let path = path(&sheet, &Rotational(bumpy), &clamp(4), &loads, 6);
    let jumps: Vec<usize> = path.iter().map(|step| step.jumps).collect();
    assert_eq!(jumps, [0, 0, 1, 0, 1, 0]);
    let jumped = |step: &&LoadStep| step.status == Status::LimitPoint;
    assert_eq!(path.iter().filter(jumped).count(), 2);
    assert!(path.iter().all(|step| step.residual <= 1e-10));
}
