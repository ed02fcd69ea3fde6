//! The weight of a sheet, and forces at other points than centroids: closed forms, balances,
//! independence of the reference point.

use crate::prelude::*;

fn pin(panel: usize) -> [Support; 2] {
    [Dof::UX, Dof::UY].map(|dof| support(panel, dof, 0.0))
}

/// A path on which every step converges.
fn path_with(solver: &EquilibriumSolver, sheet: &Sheet, law: &LinearLaw) -> Vec<LoadStep> {
    let path = follow(solver, sheet, law, None);
    assert!(converged(&path));
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

/// Panel 1 next to a clamped one, joined to it by a stiff pivot with a torsion spring; the others
/// are clamped, too, and not joined to it.
struct Pendulum {
    sheet: Sheet,
    law: LinearLaw,
    supports: Vec<Support>,
    pivot: [f64; 2],
}

const K_THETA: f64 = 0.8;

fn pendulum(points: &[AttachmentPoint]) -> Pendulum {
    let grid = Grid { m: 2, n: 2 };
    let outline = Outline::rectangle(2.0, 2.0);
    let coordinates = PatternCoordinates::uniform(grid);
    let sheet = cut(grid, outline, &coordinates, 0.1, AT_CORNER);
    let joins = |hinge: &Hinge| {
        let panels = [hinge.panel_a(), hinge.panel_b()];
        panels.contains(&0) && panels.contains(&1)
    };
    let of_hinge = |hinge: &Hinge| match joins(hinge) {
        true => [1e6, 1e6, K_THETA],
        false => [0.0; 3],
    };
    let pivot = sheet.hinges.iter().find(|hinge| joins(hinge)).unwrap();
    Pendulum {
        law: LinearLaw { stiffness: sheet.hinges.iter().map(of_hinge).collect() },
        pivot: pivot.attachment,
        supports: [0, 2, 3].into_iter().flat_map(clamp).collect(),
        sheet: sheet.attached_at(points),
    }
}

/// The angle at which a torsion spring balances a force at the end of a lever: k phi = (R(phi) arm)
/// x F.
fn balance([a_x, a_y]: [f64; 2], [f_x, f_y]: [f64; 2]) -> f64 {
    let excess = |phi: f64| {
        let (sin, cos) = phi.sin_cos();
        let (x, y) = (cos * a_x - sin * a_y, sin * a_x + cos * a_y);
        x * f_y - y * f_x - K_THETA * phi
    };
    let (mut low, mut high) = (-1.5_f64, 1.5_f64);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        let end = if excess(middle) > 0.0 { &mut low } else { &mut high };
        *end = middle;
    }
    low
}

/// A panel that hangs from a stiff pivot with a torsion spring.
#[test]
fn a_pendulum_of_two_panels() {
    let hung = pendulum(&[]);
    let panel = &hung.sheet.panels[1];
    let arm = [0, 1].map(|c| panel.centroid[c] - hung.pivot[c]);
    for by_area in [[0.0, -1.0], [0.7, -0.4], [0.0, 2.0]] {
        let solver = solver(hung.sheet.topology.grid, &hung.supports, &[], 1);
        let solver = solver.with_weight(by_area).unwrap();
        let path = path_with(&solver, &hung.sheet, &hung.law);
        assert_eq!((path.len(), solver.weight_steps()), (3, 2));
        for step in &path {
            let force = by_area.map(|w| step.weight * w * panel.area);
            assert_close(step.configuration[1][2], balance(arm, force), 2e-6);
        }
        assert_eq!((path[0].weight, path[0].load_factor), (0.5, 0.0));
    }
}

/// A force at a point of a panel has a lever that turns with the panel.
#[test]
fn a_force_at_the_middle_of_an_edge() {
    for point in [PanelPoint::Middle([1, 2]), PanelPoint::Fixed([1.7, 0.2])] {
        let moved = pendulum(&[attached(1, point)]);
        let arm = [0, 1].map(|c| moved.sheet.panels[1].reference[c] - moved.pivot[c]);
        let loads = [pull(1, 0.3), load(1, Dof::UY, -0.7)];
        let solver = solver(moved.sheet.topology.grid, &moved.supports, &loads, 4);
        for step in path_with(&solver, &moved.sheet, &moved.law) {
            let force = [0.3, -0.7].map(|force| step.load_factor * force);
            assert_close(step.configuration[1][2], balance(arm, force), 2e-6);
        }
    }
}

/// With stiff hinges the centre of gravity hangs below the nail, however the flat sheet lies.
#[test]
fn a_sheet_hangs_from_a_nail() {
    let point = PanelPoint::Fixed([0.3, 2.4]);
    let sheet = sheet_of("p1_3x3_random").attached_at(&[attached(6, point)]);
    let nail = sheet.panels[6].reference;
    for by_area in [[0.0, -1.0], [0.8, 0.6], [-0.1, 1.0]] {
        let solver = solver(sheet.topology.grid, &pin(6), &[], 1);
        assert_unsupported(&solver, &sheet);
        let solver = solver.with_weight(by_area).unwrap();
        solver.check_supports(&sheet).unwrap();
        let path = path_with(&solver, &sheet, &uniform([1e6, 1e6, 1e5], &sheet));
        let [x, y] = centre_of_gravity(&sheet, &path[2].configuration);
        let below = [x - nail[0], y - nail[1]];
        let along = below[0] * by_area[0] + below[1] * by_area[1];
        let across = below[0] * by_area[1] - below[1] * by_area[0];
        assert!(along > 0.9 && across.abs() < 1e-4, "{along} {across}");
    }
    // At its centre of gravity a sheet hangs in no definite position.
    let point = PanelPoint::Fixed(centre_of_gravity(&sheet, &[[0.0; 3]; 9]));
    let sheet = sheet.attached_at(&[attached(4, point)]);
    let balanced = solver(sheet.topology.grid, &pin(4), &[], 1).with_weight([0.0, -1.0]);
    assert_unsupported(&balanced.unwrap(), &sheet);
}

/// The state of a sheet does not depend on which point of a free panel its motion refers to.
#[test]
fn the_reference_point_of_a_panel_is_a_convention() {
    let plain = sheet_of("p1_3x3_random");
    let moved = plain.clone().attached_at(&[
        attached(4, PanelPoint::Middle([0, 1])),
        attached(7, PanelPoint::Fixed([5.0, -3.0])),
    ]);
    let corners = [plain, moved].map(|sheet| {
        let solver = solver(sheet.topology.grid, &clamp(3), &[pull(5, 2.0)], 3);
        let solver = solver.with_weight([0.1, -0.2]).unwrap();
        let path = path_with(&solver, &sheet, &uniform(SPRINGS, &sheet)).into_iter();
        let corners = path.flat_map(|step| deployed_corners(&sheet, &step.configuration));
        corners.flatten().collect::<Vec<_>>()
    });
    assert!(difference(&corners[0], &corners[1]) < 1e-9);
}

/// Stored energy = work of the weight and of the loads, along the load steps of the loads; and the
/// potential that a step states is the stored energy without the work of weight and loads.
#[test]
fn the_work_of_weight_and_loads_is_stored() {
    let by_area = [0.05, -0.2];
    let point = PanelPoint::Middle([1, 2]);
    let sheet = sheet_of("p1_3x3_random").attached_at(&[attached(5, point)]);
    let loaded = solver(sheet.topology.grid, &clamp(3), &[pull(5, 2.0)], 400);
    for solver in [loaded.clone(), loaded.driven(0.8).unwrap()] {
        let solver = solver.with_weight(by_area).unwrap();
        let path = path_with(&solver, &sheet, &uniform(SPRINGS, &sheet));
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
            assert_close(step.potential, expected, 1e-10);
        }
    }
}

#[test]
fn a_weight_that_is_no_number_is_refused() {
    let sheet = sheet_of("p0_3x3_uniform");
    let result = solver(sheet.topology.grid, &clamp(0), &[], 1).with_weight([0.0, f64::NAN]);
    let message = result.unwrap_err().to_string();
    assert_eq!(message, "the weight [0.0, NaN] N/mm^2 is not finite");
}
