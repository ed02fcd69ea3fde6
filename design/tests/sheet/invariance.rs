//! Invariances of a sheet: units, orientation, mirror image; and conservation of energy: the hinges
//! store the work of the loads.

use crate::cases;
use crate::prelude::*;
use crate::taylor::{springs, tiny};
use std::f64::consts::PI;

/// The random 3 x 3 sheet with another outline and slit width.
fn on(corners: [[f64; 2]; 4], w_lig: f64, hinge_point: HingePoint, slit_width: f64) -> Sheet {
    let coordinates = coordinates(&case("p1_3x3_random"));
    let (grid, outline) = (Grid { m: 3, n: 3 }, Outline { corners });
    let options = SheetOptions { hinge_point, process: CuttingProcess { slit_width, ..PROCESS } };
    cut(grid, outline, &coordinates, w_lig, options)
}

fn turned([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}

/// A force and a couple, clamped on the other side.
fn pulled(
    sheet: &Sheet,
    law: &dyn HingeLaw,
    force: [f64; 2],
    couple: f64,
    steps: usize,
) -> Vec<LoadStep> {
    let forces = [pull(5, force[0]), load(5, Dof::UY, force[1])];
    let loads = [&forces[..], &[load(7, Dof::Phi, couple)]].concat();
    path(sheet, law, &clamp(3), &loads, steps)
}

#[test]
fn another_unit_of_length_or_force_gives_the_same_shape() {
    let original = cases::outline(&case("p1_3x3_random"));
    let [k_a, k_s, k_theta] = SPRINGS;
    let deployed = |length: f64, force: f64| {
        let corners = original.corners.map(|corner| corner.map(|x| length * x));
        let sheet = on(corners, 0.1 * length, HingePoint::CutTip, 0.02 * length);
        let constants = [k_a / length, k_s / length, k_theta * length].map(|k| force * k);
        let law = uniform(constants, &sheet);
        let (pull, couple) = ([1.2 * force, 0.3 * force], 0.2 * force * length);
        let path = pulled(&sheet, &law, pull, couple, 5);
        assert!(converged(&path));
        let last = path[4].configuration.iter();
        let scaled = last.map(|[x, y, phi]| [x / length, y / length, *phi]);
        (scaled.collect::<Vec<_>>(), path[4].potential / (force * length))
    };
    let (expected, potential) = deployed(1.0, 1.0);
    // From metres to millimetres and back, from newtons to kilonewtons and to micronewtons.
    for (length, force) in [(1e3, 1.0), (1e-3, 1.0), (1.0, 1e-3), (1e3, 1e6)] {
        let (found, energy) = deployed(length, force);
        assert!(difference(&found, &expected) < 1e-8, "{length} {force}");
        assert_ratio(energy, potential, 1e-9);
    }
}

#[test]
fn a_scene_rotated_as_a_whole_deploys_alike() {
    let square = Outline::rectangle(300.0, 300.0);
    let laws: [(&dyn HingeLaw, HingePoint, f64); 2] =
        [(&springs(), HingePoint::Corner, 12.0), (&tiny(), HingePoint::CutTip, 1.0)];
    for (law, hinge_point, force) in laws {
        let deployed = |angle: f64| {
            let corners = square.corners.map(|corner| turned(corner, angle));
            let sheet = on(corners, 16.0, hinge_point, PROCESS.slit_width);
            pulled(&sheet, law, turned([force, 0.0], angle), 20.0 * force, 4)
        };
        let expected = deployed(0.0);
        for angle in [0.4, 0.5 * PI, -2.9] {
            for (found, expected) in std::iter::zip(deployed(angle), &expected) {
                let back = |[x, y, phi]: &[f64; 3]| {
                    let [x, y] = turned([*x, *y], -angle);
                    [x, y, *phi]
                };
                let found_back: Vec<[f64; 3]> = found.configuration.iter().map(back).collect();
                assert!(difference(&found_back, &expected.configuration) < 1e-6);
                assert_ratio(found.potential, expected.potential, 1e-9);
            }
        }
    }
}

/// (x, y) -> (-x, y) exchanges the sides of every cut: r becomes 1 - r, and the edges left and
/// right are exchanged. A hinge keeps theta and a, changes the sign of s, and has alpha on the
/// other side.
#[test]
fn a_mirrored_sheet_deploys_as_the_mirror_image() {
    let grid = Grid { m: 4, n: 3 };
    let mut random = Random::new(23);
    let drawn = PatternCoordinates {
        z: random.numbers(grid.aspect_ratio_count(), 0.8),
        ell: [4, 3, 4, 3].map(|count| random.numbers(count, 0.4)),
    };
    let reversed = |values: &[f64]| values.iter().rev().copied().collect::<Vec<f64>>();
    let [bottom, right, top, left] = &drawn.ell;
    let mirrored = PatternCoordinates {
        z: (drawn.z.chunks(grid.m - 1)).flat_map(|row| row.iter().rev().map(|z| -z)).collect(),
        ell: [reversed(bottom), left.clone(), reversed(top), right.clone()],
    };
    let mut springs = || SPRINGS.map(|k| k * (1.0 + random.number(0.3)));
    let stiffness: Vec<[f64; 3]> = (0..grid.hinge_count()).map(|_| springs()).collect();
    let sheet = |coordinates: &PatternCoordinates| {
        let outline = Outline::rectangle(4.0, 3.0);
        cut(grid, outline, coordinates, 0.1, AT_CORNER)
    };
    let (one, other) = (sheet(&drawn), sheet(&mirrored));
    // For each hinge of `other`, the hinge of `one` that it is the image of.
    let image = |hinge: &Hinge| {
        let [i, j] = hinge.site.vertex;
        let endpoint = match ((i + j) % 2 == 0, hinge.site.endpoint) {
            (true, endpoint) => endpoint,
            (false, Endpoint::X) => Endpoint::XPrime,
            (false, Endpoint::XPrime) => Endpoint::X,
        };
        let same = |h: &Hinge| h.site.vertex == [grid.m - i, j] && h.site.endpoint == endpoint;
        one.hinges.iter().position(same).unwrap()
    };
    let images: Vec<usize> = other.hinges.iter().map(image).collect();
    for (hinge, &image) in std::iter::zip(&other.hinges, &images) {
        assert_close(hinge.alpha + one.hinges[image].alpha, PI, 1e-12);
    }
    let mirrored_stiffness = images.iter().map(|&image| stiffness[image]).collect();
    let deployed = |sheet: &Sheet, stiffness: Vec<[f64; 3]>, [held, loaded]: [usize; 2], side| {
        let forces = std::iter::zip(Dof::ALL, [side * 1.2, 0.4, side * 0.1]);
        let loads: Vec<Load> = forces.map(|(dof, value)| load(loaded, dof, value)).collect();
        let law = LinearLaw { stiffness };
        path(sheet, &law, &clamp(held), &loads, 4)
    };
    let [held, loaded] = [grid.m, 2 * grid.m - 1];
    let expected = deployed(&one, stiffness, [held, loaded], 1.0);
    let found = deployed(&other, mirrored_stiffness, [loaded, held], -1.0);
    for (found, expected) in std::iter::zip(found, expected) {
        assert_eq!(found.status, Status::Converged);
        for (k, [x, y, phi]) in found.configuration.iter().enumerate() {
            let (p, q) = (k % grid.m, k / grid.m);
            let image = expected.configuration[q * grid.m + grid.m - 1 - p];
            assert!(difference(&[[-x, *y, -phi]], &[image]) < 1e-9);
        }
        for (eps, &image) in std::iter::zip(&found.deformations, &images) {
            let other = expected.deformations[image];
            assert!(difference(&[[eps.a, -eps.s, eps.theta]], &[other.to_array()]) < 1e-9);
        }
    }
}

/// Integrated by parts, the work of the loads along the path is zeta f . q at its end minus the
/// integral of f . q over zeta, computed by Simpson's rule.
#[test]
fn hinges_store_the_work_of_the_loads() {
    let square = Outline::rectangle(300.0, 300.0);
    let sheet = on(square.corners, 16.0, HingePoint::CutTip, PROCESS.slit_width);
    let laws: [(&dyn HingeLaw, f64); 2] = [(&springs(), 12.0), (&tiny(), 0.5)];
    for (law, force) in laws {
        let lost = |steps: usize| {
            let path = pulled(&sheet, law, [force, 0.0], 20.0 * force, steps);
            let work = |step: &LoadStep| {
                assert_eq!(step.status, Status::Converged);
                force * (step.configuration[5][0] + 20.0 * step.configuration[7][2])
            };
            let works: Vec<f64> = std::iter::once(0.0).chain(path.iter().map(work)).collect();
            let weights = |i: usize| match i {
                _ if i == 0 || i == steps => 1.0,
                _ if i % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let weighted = (works.iter().enumerate()).map(|(i, work)| weights(i) * work);
            let done = works[steps] - weighted.sum::<f64>() / (3.0 * steps as f64);
            let stored: f64 = path[steps - 1].energies.iter().sum();
            (done / stored - 1.0).abs()
        };
        let [coarse, fine] = [lost(20), lost(40)];
        assert!(fine < 1e-5 && coarse > 6.0 * fine, "{coarse:e} {fine:e}");
    }
}

/// A support moved to the position that a load has reached has that load as its reaction.
#[test]
fn a_moved_support_has_the_load_as_its_reaction() {
    let sheet = sheet_of("p1_3x3_random");
    let law = uniform(SPRINGS, &sheet);
    let loaded = pulled(&sheet, &law, [1.5, 0.0], 0.0, 6);
    let moved = support(5, Dof::UX, loaded[5].configuration[5][0]);
    let supports = [clamp(3).as_slice(), &[moved]].concat();
    let held = path(&sheet, &law, &supports, &[], 6);
    assert!(difference(&held[5].configuration, &loaded[5].configuration) < 1e-8);
}
