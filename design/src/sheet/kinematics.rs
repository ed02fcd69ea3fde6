//! The hinge deformation (8) as a function of the motions of its two panels, with first and second
//! derivatives.
//!
//! Let O be the attachment point of the hinge, rho = e^(-i beta)(O - c) its position relative to a
//! panel's reference point c in the cut frame (beta: the angle of e_sec), phibar and theta the mean
//! and relative rotation, and Delta = (c_l + u_l) - (c_k + u_k). In complex numbers
//!
//! ```text
//! a + i s = e^(-i(beta + phibar)) Delta + e^(i theta/2) rho_l - e^(-i theta/2) rho_k
//! ```
//!
//! This depends on only four combinations of the six motions: y = (Delta u_x, Delta u_y, phibar,
//! theta). The sum is arranged in terms that each vanish in the flat sheet, so that small motions
//! keep their accuracy.

use crate::{
    geometry::{
        plane::{I, complex, cross, dot, point, turn, turn_less_one},
        polygon::distance,
    },
    sheet::cut_sheet::{Hinge, Panel, Sheet},
};
use faer::c64;
use hinge::HingeDeformation;
use std::iter::zip;
use support::{Point, vectors};

/// A rigid motion (u_x, u_y, phi) of a panel (mm, mm, rad), or forces and a moment on it.
pub type Motion = [f64; 3];

/// The motion of every panel relative to the flat sheet.
pub type Configuration = Vec<Motion>;

/// The deployed position of a point of a panel with the motion `motion`.
pub fn deployed(panel: &Panel, motion: Motion, flat: Point) -> Point {
    let [u_x, u_y, phi] = motion;
    let reference = complex(panel.reference);
    point(c64::new(u_x, u_y) + reference + turn(phi) * (complex(flat) - reference))
}

/// The deployed corners SW, SE, NE, NW of every panel (mm).
pub fn deployed_corners(sheet: &Sheet, configuration: &[Motion]) -> Vec<[Point; 4]> {
    zip(&sheet.panels, configuration)
        .map(|(panel, &motion)| panel.corners.map(|corner| deployed(panel, motion, corner)))
        .collect()
}

/// The deployed boundary of every panel (mm).
pub fn deployed_boundaries(sheet: &Sheet, configuration: &[Motion]) -> Vec<Vec<Point>> {
    let moved = |(panel, motion): (&Panel, &Motion)| {
        panel.boundary.iter().map(|point| deployed(panel, *motion, *point)).collect()
    };
    zip(&sheet.panels, configuration).map(moved).collect()
}

/// Distance of every panel corner between two configurations (mm).
pub fn corner_distances(sheet: &Sheet, from: &[Motion], to: &[Motion]) -> Vec<f64> {
    let [from, to] = [from, to].map(|configuration| deployed_corners(sheet, configuration));
    zip(from.as_flattened(), to.as_flattened()).map(|(p, q)| distance(*p, *q)).collect()
}

/// The gradient in (motion, flat point, reference point) of a function with the given gradient in
/// the deployed position of the point.
pub fn deployed_pullback(
    panel: &Panel,
    motion: Motion,
    flat: Point,
    gradient: Point,
) -> (Motion, c64, c64) {
    let force = complex(gradient);
    let spin = turn(motion[2]);
    let arm = spin * (complex(flat) - complex(panel.reference));
    let by_flat = force * spin.conj();
    ([force.re, force.im, cross(arm, force)], by_flat, force - by_flat)
}

/// The deformation (8) of every hinge.
pub fn hinge_deformations(sheet: &Sheet, configuration: &[Motion]) -> Vec<HingeDeformation> {
    let motions = HingeMotion::all(sheet, configuration);
    motions.iter().map(HingeMotion::deformation).collect()
}

/// The kinematics of a hinge in one configuration: the terms of (8) from which its derivatives are
/// computed.
#[derive(Clone, Copy, Debug)]
pub struct HingeMotion {
    /// Relative rotation (rad).
    theta: f64,
    /// a + i s
    translation: c64,
    /// Rounding errors of `translation` and of `theta`.
    rounding: [f64; 2],
    /// e^(-i beta), the flat sheet seen from the cut frame.
    frame: c64,
    /// e^(i theta/2)
    half: c64,
    /// e^(-i(beta + phibar))
    mean: c64,
    /// mean Delta
    separation: c64,
    /// half rho_l
    arm_b: c64,
    /// rho_k / half
    arm_a: c64,
}

/// The gradient of a scalar with respect to the flat geometry in (8).
#[derive(Clone, Copy, Debug, Default)]
pub struct HingeGeometryGradient {
    /// Gradient in the attachment point.
    pub attachment: c64,
    /// Gradient in the reference point of panel A.
    pub reference_a: c64,
    /// Gradient in the reference point of panel B.
    pub reference_b: c64,
    /// Gradient in the angle of e_sec.
    pub frame_angle: f64,
}

impl HingeMotion {
    /// The motions of all hinges of a sheet.
    pub fn all(sheet: &Sheet, configuration: &[Motion]) -> Vec<Self> {
        let hinges = 0..sheet.hinges.len();
        hinges.map(|h| Self::new(sheet, h, configuration)).collect()
    }

    /// The kinematics of one hinge, given by its index.
    pub fn new(sheet: &Sheet, hinge: usize, configuration: &[Motion]) -> Self {
        let hinge = &sheet.hinges[hinge];
        let [a, b] = hinge.panels();
        let [c_a, c_b] = [a, b].map(|panel| complex(sheet.panels[panel].reference));
        let ([ax, ay, phi_a], [bx, by, phi_b]) = (configuration[a], configuration[b]);
        let (theta, phibar) = (phi_b - phi_a, 0.5 * (phi_a + phi_b));
        let frame = complex(hinge.e_sec).conj();
        let (turned_back, opened) = (turn_less_one(-phibar), turn_less_one(0.5 * theta));
        let (mean, half) = (frame + frame * turned_back, 1.0 + opened);
        let attachment = complex(hinge.attachment);
        let (rho_a, rho_b) = (frame * (attachment - c_a), frame * (attachment - c_b));
        let (shift, offset) = (c64::new(bx - ax, by - ay), c_b - c_a);
        let terms =
            [mean * shift, frame * turned_back * offset, opened * rho_b, -opened.conj() * rho_a];
        let sizes: f64 = terms.iter().map(|z| z.re.abs() + z.im.abs()).sum();
        Self {
            theta,
            translation: terms.iter().sum(),
            rounding: [sizes, phi_a.abs() + phi_b.abs()].map(|size| f64::EPSILON * size),
            frame,
            half,
            mean,
            separation: mean * (shift + offset),
            arm_b: half * rho_b,
            arm_a: half.conj() * rho_a,
        }
    }

    /// (a, s, theta).
    pub fn deformation(&self) -> HingeDeformation {
        HingeDeformation { a: self.translation.re, s: self.translation.im, theta: self.theta }
    }

    /// Rounding errors of a and s (mm) and of theta (rad), which are differences of larger numbers.
    pub fn rounding(&self) -> [f64; 2] {
        self.rounding
    }

    /// d(a + i s)/dy for y = (Delta u_x, Delta u_y, phibar, theta).
    fn translation_rates(&self) -> [c64; 4] {
        [self.mean, I * self.mean, -I * self.separation, 0.5 * I * (self.arm_a + self.arm_b)]
    }

    /// The generalised forces on panels A and B, (F_x, F_y, M) each, for a gradient in (a, s,
    /// theta).
    pub fn forces(&self, gradient: [f64; 3]) -> [f64; 6] {
        let [f_a, f_s, m_theta] = gradient;
        let force = c64::new(f_a, f_s);
        let mut by_y = self.translation_rates().map(|rate| dot(force, rate));
        by_y[3] += m_theta;
        let [x, y, mean, relative] = by_y;
        [-x, -y, 0.5 * mean - relative, x, y, 0.5 * mean + relative]
    }

    /// The rate of (a, s, theta) under a motion of panels A and B.
    pub fn rates(&self, motion: [f64; 6]) -> [f64; 3] {
        let y = relative_motion(motion);
        let translation: c64 = zip(self.translation_rates(), y).map(|(rate, y)| rate * y).sum();
        [translation.re, translation.im, y[3]]
    }

    /// The 6 x 6 tangent J^T K J + f . d2(eps), in the motions of panels A and B, of an energy with
    /// the stiffness K = `tangent` and the forces f.
    pub fn stiffness(&self, tangent: &[[f64; 3]; 3], forces: [f64; 3]) -> [[f64; 6]; 6] {
        // The coordinates are z = (Delta u_x, Delta u_y, phi_k, phi_l); the six motions enter with
        // the signs of COPIES.
        let [x, y, mean, relative] = self.translation_rates();
        let rates = [x, y, 0.5 * mean - relative, 0.5 * mean + relative];
        let mut jacobian = [[0.0; 4], [0.0; 4], [0.0, 0.0, -1.0, 1.0]];
        for (j, rate) in rates.into_iter().enumerate() {
            (jacobian[0][j], jacobian[1][j]) = (rate.re, rate.im);
        }
        let mut by_z = [[0.0; 4]; 4];
        for (row, of_row) in zip(tangent, &jacobian) {
            for j in 0..4 {
                let product =
                    row[0] * jacobian[0][j] + row[1] * jacobian[1][j] + row[2] * jacobian[2][j];
                for i in 0..4 {
                    by_z[i][j] += of_row[i] * product;
                }
            }
        }
        let force = c64::new(forces[0], forces[1]);
        for (axis, rate) in [x, y].into_iter().enumerate() {
            let mixed = 0.5 * dot(force, -I * rate);
            for angle in [2, 3] {
                by_z[axis][angle] += mixed;
                by_z[angle][axis] += mixed;
            }
        }
        let turned = -0.25 * dot(force, self.separation);
        let opened = -0.25 * dot(force, self.arm_b - self.arm_a);
        for (i, j) in [(2, 2), (2, 3), (3, 2), (3, 3)] {
            by_z[i][j] += if i == j { turned + opened } else { turned - opened };
        }
        const COPIES: [(usize, f64); 6] =
            [(0, -1.0), (1, -1.0), (2, 1.0), (0, 1.0), (1, 1.0), (3, 1.0)];
        let mut stiffness = [[0.0; 6]; 6];
        for (row, (i, sign)) in zip(&mut stiffness, COPIES) {
            for (entry, (j, other)) in zip(row, COPIES) {
                *entry = sign * other * by_z[i][j];
            }
        }
        stiffness
    }

    /// The gradient of `weights . (a, s, theta)` with respect to the flat geometry.
    pub fn geometry_gradient(&self, weights: [f64; 3]) -> HingeGeometryGradient {
        let force = c64::new(weights[0], weights[1]);
        let back = force * self.frame.conj();
        HingeGeometryGradient {
            attachment: back * (self.half - self.half.conj()).conj(),
            reference_a: force * (self.frame * self.half.conj() - self.mean).conj(),
            reference_b: force * (self.mean - self.frame * self.half).conj(),
            frame_angle: cross(force, self.translation),
        }
    }

    /// The gradient of `forces . rates(motion)` with respect to the flat geometry, at fixed
    /// `forces`.
    pub fn rates_geometry_gradient(
        &self,
        forces: [f64; 3],
        motion: [f64; 6],
    ) -> HingeGeometryGradient {
        let force = c64::new(forces[0], forces[1]);
        let [_, _, mean, relative] = relative_motion(motion);
        let [a, s, _] = self.rates(motion);
        let (spin, open) = (-I * mean * self.mean, 0.5 * I * relative * self.frame);
        HingeGeometryGradient {
            attachment: force * (open * (self.half + self.half.conj())).conj(),
            reference_a: force * (-spin - open * self.half.conj()).conj(),
            reference_b: force * (spin - open * self.half).conj(),
            frame_angle: cross(force, c64::new(a, s)),
        }
    }
}

/// y = (Delta u_x, Delta u_y, phibar, theta) of a motion of panels A and B.
fn relative_motion([ax, ay, phi_a, bx, by, phi_b]: [f64; 6]) -> [f64; 4] {
    [bx - ax, by - ay, 0.5 * (phi_a + phi_b), phi_b - phi_a]
}

/// Adds `factor` times a vector (x, y, phi) per panel to a sum.
pub(crate) fn add_motions(sum: &mut [Motion], motion: &[Motion], factor: f64) {
    vectors::add(sum.as_flattened_mut(), motion.as_flattened(), factor);
}

/// The components of the two panels of a hinge.
pub(crate) fn at_hinge(hinge: &Hinge, by_panel: &[Motion]) -> [f64; 6] {
    let [a, b] = hinge.panels().map(|panel| by_panel[panel]);
    [a[0], a[1], a[2], b[0], b[1], b[2]]
}

/// Adds the components of the two panels of a hinge.
pub(crate) fn add_at_hinge(by_panel: &mut [Motion], hinge: &Hinge, components: [f64; 6]) {
    for (panel, components) in zip(hinge.panels(), components.chunks(3)) {
        vectors::add(&mut by_panel[panel], components, 1.0);
    }
}
