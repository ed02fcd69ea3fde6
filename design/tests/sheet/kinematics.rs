//! (8) and its derivatives: finite differences, objectivity, and the relation between its two
//! reference points.

use crate::cases;
use crate::prelude::*;
use design::geometry::plane::point;
use design::sheet::kinematics::{Configuration, HingeGeometryGradient, HingeMotion};

fn sheet(options: SheetOptions) -> Sheet {
    let pattern = cases::pattern(&case("p1_3x3_random"));
    let widths = Random::new(1).numbers(pattern.grid.hinge_count(), 0.05);
    let widths: Vec<f64> = widths.iter().map(|w| 0.1 + w).collect();
    Sheet::new(&pattern, &widths, options).unwrap()
}

fn deformation(sheet: &Sheet, hinge: usize, configuration: &[[f64; 3]]) -> [f64; 3] {
    let motion = HingeMotion::new(sheet, hinge, configuration);
    motion.deformation().to_array()
}

/// The configuration with the motions of the two panels of a hinge replaced.
fn with_motion(sheet: &Sheet, hinge: usize, q: &Configuration, motion: &[f64]) -> Configuration {
    let mut q = q.clone();
    q[sheet.hinges[hinge].panel_a()].copy_from_slice(&motion[..3]);
    q[sheet.hinges[hinge].panel_b()].copy_from_slice(&motion[3..]);
    q
}

fn unit<const N: usize>(i: usize) -> [f64; N] {
    std::array::from_fn(|j| f64::from(i == j))
}

/// 1e-8 of the slope, and of one.
fn allowed(slope: f64) -> f64 {
    1e-8 * (1.0 + slope.abs())
}

#[test]
fn first_and_second_derivatives_in_the_panel_motions() {
    let sheet = sheet(AT_TIP);
    let mut random = Random::new(2);
    let q = random.arrays(sheet.panels.len(), 0.7);
    for h in 0..sheet.hinges.len() {
        let [a, b] = [sheet.hinges[h].panel_a(), sheet.hinges[h].panel_b()].map(|k| q[k]);
        let x = [a[0], a[1], a[2], b[0], b[1], b[2]];
        let motion = HingeMotion::new(&sheet, h, &q);
        // W = f . eps + eps . K eps / 2 with a full K.
        let linear: [f64; 3] = random.arrays(1, 1.0)[0];
        let root: [[f64; 3]; 3] = std::array::from_fn(|_| random.arrays(1, 1.0)[0]);
        let tangent: [[f64; 3]; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| (0..3).map(|k| root[i][k] * root[j][k]).sum())
        });
        let forces_at = |eps: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|i| linear[i] + (0..3).map(|j| tangent[i][j] * eps[j]).sum::<f64>())
        };
        let panel_forces = |x: &[f64]| {
            let q = with_motion(&sheet, h, &q, x);
            let motion = HingeMotion::new(&sheet, h, &q);
            motion.forces(forces_at(motion.deformation().to_array()))
        };
        let stiffness = motion.stiffness(&tangent, forces_at(motion.deformation().to_array()));
        for (i, row) in stiffness.iter().enumerate() {
            assert_gradient(|x| panel_forces(x)[i], &x, row, 1e-6, allowed);
        }
        for c in 0..3 {
            let rates: [f64; 6] = std::array::from_fn(|i| motion.rates(unit(i))[c]);
            let value = |x: &[f64]| deformation(&sheet, h, &with_motion(&sheet, h, &q, x))[c];
            assert_gradient(value, &x, &rates, 1e-6, allowed);
            for (force, rate) in std::iter::zip(motion.forces(unit(c)), rates) {
                assert_close(force, rate, allowed(rate));
            }
        }
    }
}

#[test]
fn derivatives_in_the_flat_geometry() {
    let flat = sheet(AT_TIP);
    let mut random = Random::new(3);
    let q = random.arrays(flat.panels.len(), 0.7);
    for h in 0..flat.hinges.len() {
        // x: attachment point, two reference points, angle of e_sec.
        let (a, b) = (flat.hinges[h].panel_a(), flat.hinges[h].panel_b());
        let moved = |x: &[f64]| {
            let mut sheet = flat.clone();
            sheet.hinges[h].attachment = [x[0], x[1]];
            sheet.panels[a].reference = [x[2], x[3]];
            sheet.panels[b].reference = [x[4], x[5]];
            sheet.hinges[h].e_sec = [x[6].cos(), x[6].sin()];
            sheet
        };
        let [e_x, e_y] = flat.hinges[h].e_sec;
        let mut x = [0.0; 7];
        x[..2].copy_from_slice(&flat.hinges[h].attachment);
        x[2..4].copy_from_slice(&flat.panels[a].reference);
        x[4..6].copy_from_slice(&flat.panels[b].reference);
        x[6] = e_y.atan2(e_x);
        let (weights, virtual_motion) = (random.arrays(1, 1.0)[0], random.arrays(1, 1.0)[0]);
        let weighted = |eps: [f64; 3]| std::iter::zip(weights, eps).map(|(w, e): (f64, f64)| w * e);
        let motion = HingeMotion::new(&flat, h, &q);
        let by_deformation = flattened(motion.geometry_gradient(weights));
        let value = |x: &[f64]| weighted(deformation(&moved(x), h, &q)).sum();
        assert_gradient(value, &x, &by_deformation, 1e-6, allowed);
        let by_rates = flattened(motion.rates_geometry_gradient(weights, virtual_motion));
        let rates = |sheet: &Sheet| HingeMotion::new(sheet, h, &q).rates(virtual_motion);
        let value = |x: &[f64]| weighted(rates(&moved(x))).sum();
        assert_gradient(value, &x, &by_rates, 1e-6, allowed);
    }
}

fn flattened(gradient: HingeGeometryGradient) -> [f64; 7] {
    let [ox, oy] = point(gradient.attachment);
    let [[ax, ay], [bx, by]] = [gradient.reference_a, gradient.reference_b].map(point);
    [ox, oy, ax, ay, bx, by, gradient.frame_angle]
}

#[test]
fn a_rigid_motion_of_the_whole_sheet_deforms_no_hinge() {
    let sheet = sheet(AT_TIP);
    let q: Configuration = Random::new(4).arrays(sheet.panels.len(), 0.5);
    for (shift, angle) in [([3.0, -2.0], 0.0), ([0.0, 0.0], 2.5), ([-1.0, 4.0], -1.1)] {
        let (sin, cos) = f64::sin_cos(angle);
        let turned: Configuration = std::iter::zip(&sheet.panels, &q)
            .map(|(panel, [u_x, u_y, phi])| {
                let [c_x, c_y] = panel.reference;
                let (x, y) = (c_x + u_x, c_y + u_y);
                [
                    cos * x - sin * y + shift[0] - c_x,
                    sin * x + cos * y + shift[1] - c_y,
                    phi + angle,
                ]
            })
            .collect();
        let [before, after] = [&q, &turned].map(|q| hinge_deformations(&sheet, q));
        for (before, after) in std::iter::zip(before, after) {
            for (before, after) in std::iter::zip(before.to_array(), after.to_array()) {
                assert_close(before, after, 2e-13);
            }
        }
    }
}

#[test]
fn tip_and_corner_measure_the_same_motion() {
    let (at_corner, at_tip) = (sheet(AT_CORNER), sheet(AT_TIP));
    let q = Random::new(5).arrays(at_corner.panels.len(), 0.6);
    let [corners, tips] = [&at_corner, &at_tip].map(|sheet| hinge_deformations(sheet, &q));
    for (hinge, (corner, tip)) in at_tip.hinges.iter().zip(std::iter::zip(corners, tips)) {
        let opening = 2.0 * hinge.set_back * (0.5 * corner.theta).sin();
        assert!((tip.a - corner.a - opening).abs() < 1e-13);
        assert!((tip.s - corner.s - opening / hinge.alpha.tan()).abs() < 1e-13);
        assert_eq!(tip.theta, corner.theta);
    }
}
