//! The weight of a sheet, and forces at other points than centroids: closed forms, balances,
//! independence of the reference point.

use crate::cases::{self, AT_CORNER, case, difference};
use crate::closed_forms::clamp;
use design::equilibrium::hinged_sheet::HingedSheet;
use design::equilibrium::load_step::{LoadStep, Status};
use design::equilibrium::settings::SolverSettings;
use design::equilibrium::solver::{EquilibriumError, EquilibriumSolver};
use design::equilibrium::supports::{Dof, Load, Support};
use design::hinge_law::{HingeLaw, LinearLaw};
use design::pattern::coordinates::PatternCoordinates;
use design::pattern::cut_pattern::{CutPattern, Outline};
use design::pattern::grid::Grid;
use design::sheet::cut_sheet::{Grip, PanelPoint, Sheet};
use design::sheet::kinematics::{deployed, deployed_corners};

fn pulled(panel: usize, dof: Dof, value: f64) -> Load {
    Load { panel, dof, value }
}

fn pin(panel: usize) -> [Support; 2] {
    [Dof::UX, Dof::UY].map(|dof| Support {
        panel,
        dof,
        value: 0.0,
    })
}

fn solver(sheet: &Sheet, supports: &[Support], loads: &[Load], steps: usize) -> EquilibriumSolver {
    let settings = SolverSettings::default();
    EquilibriumSolver::new(sheet.grid, supports, loads, steps, settings).unwrap()
}

fn path(solver: &EquilibriumSolver, sheet: &Sheet, stiffness: [f64; 3]) -> Vec<LoadStep> {
    let law = LinearLaw::uniform(stiffness, sheet.hinges.len());
    path_with(solver, sheet, &law)
}

fn path_with(solver: &EquilibriumSolver, sheet: &Sheet, law: &LinearLaw) -> Vec<LoadStep> {
    let law = law.prepare(&sheet.designs());
    let path = solver.path(HingedSheet {
        sheet,
        law: &*law,
        contact: None,
        damage_gradient: false,
    });
    for step in &path {
        assert_eq!(step.status, Status::Converged, "{step}");
    }
    path
}

fn centre_of_gravity(sheet: &Sheet, configuration: &[[f64; 3]]) -> [f64; 2] {
    let area: f64 = sheet.panels.iter().map(|panel| panel.area).sum();
    [0, 1].map(|c| {
        let panels = std::iter::zip(&sheet.panels, configuration);
        let moments =
            panels.map(|(panel, motion)| panel.area * deployed(panel, *motion, panel.centroid)[c]);
        moments.sum::<f64>() / area
    })
}

/// Panel 1 beside a clamped one, joined to it by a stiff pivot with a torsion spring; the others are clamped, too, and not
/// joined to it.
struct Pendulum {
    sheet: Sheet,
    law: LinearLaw,
    supports: Vec<Support>,
    pivot: [f64; 2],
}

const K_THETA: f64 = 0.8;

fn pendulum(grips: &[Grip]) -> Pendulum {
    let grid = Grid { m: 2, n: 2 };
    let coordinates = PatternCoordinates::uniform(grid);
    let pattern = CutPattern::new(grid, Outline::rectangle(2.0, 2.0), &coordinates).unwrap();
    let sheet = Sheet::new(&pattern, &[0.1; 4], AT_CORNER).unwrap();
    let joins =
        |panel_a, panel_b| [panel_a, panel_b].contains(&0) && [panel_a, panel_b].contains(&1);
    let of_hinge = |(panel_a, panel_b)| {
        if joins(panel_a, panel_b) {
            [1e6, 1e6, K_THETA]
        } else {
            [0.0; 3]
        }
    };
    let hinges = sheet.hinges.iter();
    let panels = || {
        hinges
            .clone()
            .map(|hinge| (hinge.panel_a(), hinge.panel_b()))
    };
    let pivot = panels().position(|(a, b)| joins(a, b)).unwrap();
    Pendulum {
        law: LinearLaw {
            stiffness: panels().map(of_hinge).collect(),
        },
        pivot: sheet.hinges[pivot].attachment,
        sheet: sheet.clone().gripped(grips),
        supports: [0, 2, 3].into_iter().flat_map(clamp).collect(),
    }
}

/// The angle at which a torsion spring balances a force at the end of a lever: k phi = (R(phi) arm) x F.
fn balance([a_x, a_y]: [f64; 2], [f_x, f_y]: [f64; 2]) -> f64 {
    let excess = |phi: f64| {
        let (sin, cos) = phi.sin_cos();
        let (x, y) = (cos * a_x - sin * a_y, sin * a_x + cos * a_y);
        x * f_y - y * f_x - K_THETA * phi
    };
    let (mut low, mut high) = (-1.5_f64, 1.5_f64);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if excess(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// A panel that hangs from a stiff pivot with a torsion spring.
#[test]
fn a_pendulum_of_two_panels() {
    let Pendulum {
        sheet,
        law,
        supports,
        pivot,
    } = pendulum(&[]);
    let panel = sheet.panels[1];
    let arm = [0, 1].map(|c| panel.centroid[c] - pivot[c]);
    for by_area in [[0.0, -1.0], [0.7, -0.4], [0.0, 2.0]] {
        let solver = solver(&sheet, &supports, &[], 1);
        let solver = solver.with_weight(by_area).unwrap();
        let path = path_with(&solver, &sheet, &law);
        assert_eq!((path.len(), solver.weight_steps()), (3, 2));
        for step in &path {
            let force = by_area.map(|w| step.weight * w * panel.area);
            let expected = balance(arm, force);
            let found = step.configuration[1][2];
            assert!((found - expected).abs() < 2e-6, "{found} {expected}");
        }
        assert_eq!(path[0].weight, 0.5);
        assert_eq!(path[0].load_factor, 0.0);
    }
}

/// A force at a point of a panel has a lever that turns with the panel.
#[test]
fn a_force_at_the_middle_of_an_edge() {
    for point in [PanelPoint::Middle([1, 2]), PanelPoint::Fixed([1.7, 0.2])] {
        let Pendulum {
            sheet,
            law,
            supports,
            pivot,
        } = pendulum(&[Grip { panel: 1, point }]);
        let arm = [0, 1].map(|c| sheet.panels[1].reference[c] - pivot[c]);
        let loads = [pulled(1, Dof::UX, 0.3), pulled(1, Dof::UY, -0.7)];
        let solver = solver(&sheet, &supports, &loads, 4);
        for step in path_with(&solver, &sheet, &law) {
            let force = [0.3, -0.7].map(|force| step.load_factor * force);
            let expected = balance(arm, force);
            let found = step.configuration[1][2];
            assert!((found - expected).abs() < 2e-6, "{found} {expected}");
        }
    }
}

/// With stiff hinges the centre of gravity hangs below the nail, however the flat sheet lies.
#[test]
fn a_sheet_hangs_from_a_nail() {
    let point = PanelPoint::Fixed([0.3, 2.4]);
    let sheet = cases::sheet(&case("p1_3x3_random")).gripped(&[Grip { panel: 6, point }]);
    let nail = sheet.panels[6].reference;
    for by_area in [[0.0, -1.0], [0.8, 0.6], [-0.1, 1.0]] {
        let solver = solver(&sheet, &pin(6), &[], 1);
        assert_eq!(
            solver.check_supports(&sheet),
            Err(EquilibriumError::Unsupported)
        );
        let solver = solver.with_weight(by_area).unwrap();
        solver.check_supports(&sheet).unwrap();
        let path = path(&solver, &sheet, [1e6, 1e6, 1e5]);
        let [x, y] = centre_of_gravity(&sheet, &path[2].configuration);
        let below = [x - nail[0], y - nail[1]];
        let along = below[0] * by_area[0] + below[1] * by_area[1];
        let across = below[0] * by_area[1] - below[1] * by_area[0];
        assert!(along > 0.9 && across.abs() < 1e-4, "{along} {across}");
    }
    // At its centre of gravity a sheet hangs in no definite position.
    let at_rest = vec![[0.0; 3]; 9];
    let middle = PanelPoint::Fixed(centre_of_gravity(&sheet, &at_rest));
    let sheet = sheet.gripped(&[Grip {
        panel: 4,
        point: middle,
    }]);
    let balanced = solver(&sheet, &pin(4), &[], 1).with_weight([0.0, -1.0]);
    assert_eq!(
        balanced.unwrap().check_supports(&sheet),
        Err(EquilibriumError::Unsupported)
    );
}

/// The state of a sheet does not depend on which point of a free panel its motion refers to.
#[test]
fn the_reference_point_of_a_panel_is_a_convention() {
    let plain = cases::sheet(&case("p1_3x3_random"));
    let grip = |panel, point| Grip { panel, point };
    let gripped = plain.clone().gripped(&[
        grip(4, PanelPoint::Middle([0, 1])),
        grip(7, PanelPoint::Fixed([5.0, -3.0])),
    ]);
    let corners = [plain, gripped].map(|sheet| {
        let solver = solver(&sheet, &clamp(3), &[pulled(5, Dof::UX, 2.0)], 3);
        let solver = solver.with_weight([0.1, -0.2]).unwrap();
        let path = path(&solver, &sheet, [90.0, 40.0, 0.8]);
        path.iter()
            .flat_map(|step| deployed_corners(&sheet, &step.configuration))
            .flatten()
            .collect::<Vec<_>>()
    });
    assert!(difference(&corners[0], &corners[1]) < 1e-9);
}

/// Stored energy = work of the weight and of the loads, along the load steps of the loads; and the potential that a step
/// states is the stored energy without the work of weight and loads.
#[test]
fn the_work_of_weight_and_loads_is_stored() {
    let by_area = [0.05, -0.2];
    let grips = [Grip {
        panel: 5,
        point: PanelPoint::Middle([1, 2]),
    }];
    let sheet = cases::sheet(&case("p1_3x3_random")).gripped(&grips);
    let load = [pulled(5, Dof::UX, 2.0)];
    for stroke in [None, Some(0.8)] {
        let solver = solver(&sheet, &clamp(3), &load, 400);
        let solver = match stroke {
            Some(stroke) => solver.driven(stroke).unwrap(),
            None => solver,
        };
        let solver = solver.with_weight(by_area).unwrap();
        let path = path(&solver, &sheet, [90.0, 40.0, 0.8]);
        let stored = |step: &LoadStep| step.energies.iter().sum::<f64>();
        let weighed = |step: &LoadStep| -> f64 {
            let panels = std::iter::zip(&sheet.panels, &step.configuration);
            let works = panels.map(|(panel, &motion)| {
                let [x, y] = panel.centroid;
                let [moved_x, moved_y] = deployed(panel, motion, panel.centroid);
                panel.area * (by_area[0] * (moved_x - x) + by_area[1] * (moved_y - y))
            });
            works.sum()
        };
        let way = |step: &LoadStep| 2.0 * step.configuration[5][0];
        let loaded = &path[solver.weight_steps() - 1..];
        let work: f64 = (loaded.windows(2))
            .map(|pair| {
                let mean = 0.5 * (pair[0].load_factor + pair[1].load_factor);
                mean * (way(&pair[1]) - way(&pair[0])) + weighed(&pair[1]) - weighed(&pair[0])
            })
            .sum();
        let (first, last) = (&loaded[0], &loaded[loaded.len() - 1]);
        let gained = stored(last) - stored(first);
        assert!((work - gained).abs() < 1e-5 * gained, "{work} {gained}");
        for step in loaded {
            let expected = stored(step) - weighed(step) - step.load_factor * way(step);
            assert!((step.potential - expected).abs() < 1e-10);
        }
    }
}

#[test]
fn a_weight_that_is_no_number_is_refused() {
    let sheet = cases::sheet(&case("p0_3x3_uniform"));
    let result = solver(&sheet, &clamp(0), &[], 1).with_weight([0.0, f64::NAN]);
    assert!(matches!(result, Err(EquilibriumError::Weight(_))));
}
