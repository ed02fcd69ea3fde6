//! Cards of CalculiX input decks that windows and sheets have in common. Nodes and elements count
//! from 0 here and from 1 in a deck.

use crate::{DeformationPath, StepControl};
use hinge::{HingeDeformation, SheetMaterial};
use support::{Joined, Point, add_line};

/// A number in a format that ccx reads: a field has 20 characters, and this format uses at most 19.
pub(crate) fn real(x: f64) -> String {
    format!("{x:.11e}")
}

/// All nodes, as the set NALL.
pub(crate) fn write_nodes(d: &mut String, nodes: &[[f64; 3]]) {
    add_line!(d, "*NODE,NSET=NALL");
    nodes.iter().enumerate().for_each(|(node, [x, y, z])| {
        add_line!(d, "{},{},{},{}", node + 1, real(*x), real(*y), real(*z))
    })
}

/// The line of an element.
pub(crate) fn write_element(d: &mut String, element: usize, nodes: &[usize]) {
    let numbers = [element].into_iter().chain(nodes.iter().copied());
    let numbers: Vec<String> = numbers.map(|number| (number + 1).to_string()).collect();
    // A line has at most 16 entries.
    let lines = numbers.chunks(16).map(|line| line.join(",")).joined(",\n");
    add_line!(d, "{lines}");
}

/// A set of nodes (NSET) or elements (ELSET), unless it is empty.
pub(crate) fn write_set(d: &mut String, kind: &str, name: &str, members: &[usize]) {
    if !members.is_empty() {
        add_line!(d, "*{kind},{kind}={name}");
        members.iter().for_each(|member| add_line!(d, "{},", member + 1));
    }
}

/// The material SHEET with its elastic and plastic law.
pub(crate) fn write_material(d: &mut String, material: &SheetMaterial) {
    let (young, poisson) = (real(material.young), real(material.poisson));
    add_line!(d, "*MATERIAL,NAME=SHEET\n*ELASTIC\n{young},{poisson}\n*PLASTIC");
    material
        .plastic
        .iter()
        .for_each(|[stress, strain]| add_line!(d, "{},{}", real(*stress), real(*strain)))
}

/// A table of (time since the beginning of the first step, value).
pub(crate) fn write_amplitude(d: &mut String, name: &str, pairs: impl IntoIterator<Item = Point>) {
    add_line!(d, "*AMPLITUDE,NAME={name},TIME=TOTAL TIME");
    let pairs: Vec<String> = (pairs.into_iter())
        .map(|[time, value]| format!("{},{}", real(time), real(value)))
        .collect();
    // A line has at most 4 pairs.
    pairs.chunks(4).for_each(|line| add_line!(d, "{}", line.join(",")))
}

/// The increments of a step of the given duration, and its tolerances.
pub(crate) fn write_increments(d: &mut String, step: &StepControl, duration: f64) {
    let [initial, least, greatest] =
        [step.initial, step.least, step.greatest].map(|part| real(duration * part));
    let (residual, correction) = (real(step.residual), real(step.correction));
    add_line!(d, "{initial},{},{least},{greatest}", real(duration));
    add_line!(d, "*CONTROLS,PARAMETERS=FIELD\n{residual},{correction},,,0.04")
}

// An arc of a window that moves with a rigid panel.
//
// Two control nodes without elements carry the four amplitudes of the motion ([`PanelMotion`]);
// linear constraint equations couple the arc to them.

/// Number of intervals of the amplitude tables. Between entries the motion is linear: the chord
/// shortens the lever arm of an arc by r dtheta^2 / 8. Intervals of 0.1 deg keep the energy error
/// of a window below 3e-4.
pub(crate) const AMPLITUDE_INTERVALS: usize = 720;

/// An arc with the nodes that drive it.
pub(crate) struct DrivenArc<'a> {
    /// Nodes of the arc, counted from 0.
    pub nodes: &'a [usize],
    /// The point to which the motion refers, in the undeformed mesh (mm).
    pub about: Point,
    /// The control nodes of (q1, q2) and of (q3, q4), counted from 1.
    pub drivers: [usize; 2],
}

impl DrivenArc<'_> {
    /// The two constraint equations of every node of the arc.
    pub(crate) fn write_equations(&self, d: &mut String, positions: &[[f64; 3]]) {
        let [turner, mover] = self.drivers;
        add_line!(d, "*EQUATION");
        for index in self.nodes {
            let node = index + 1;
            let [x, y] = [0, 1].map(|i| positions[*index][i] - self.about[i]);
            for (freedom, by_q1, by_q2) in [(1, -x, y), (2, -y, -x)] {
                let (by_q1, by_q2) = (real(by_q1), real(by_q2));
                add_line!(
                    d,
                    "4\n{node},{freedom},1.,{turner},1,{by_q1},{turner},2,{by_q2},{mover},{freedom},-1."
                );
            }
        }
    }

    /// The boundary conditions of the control nodes in the plane.
    pub(crate) fn write_boundary(&self, d: &mut String) {
        let [turner, mover] = self.drivers;
        let freedoms = [(turner, 1), (turner, 2), (mover, 1), (mover, 2)];
        for (i, (node, freedom)) in freedoms.into_iter().enumerate() {
            add_line!(d, "*BOUNDARY,AMPLITUDE=Q{}", i + 1);
            add_line!(d, "{node},{freedom},{freedom},1.");
        }
    }
}

/// The motion along a path at given lambdas.
pub(crate) fn write_motion(d: &mut String, lambdas: &[f64], path: &DeformationPath) {
    for i in 0..4 {
        let at = |lambda: &f64| [*lambda, PanelMotion::new(&path.at(*lambda)).amplitudes()[i]];
        write_amplitude(d, &format!("Q{}", i + 1), lambdas.iter().map(at));
    }
}

/// Lambdas at equal distances, from 0 to 1.
pub(crate) fn even_lambdas() -> impl Iterator<Item = f64> {
    (0..=AMPLITUDE_INTERVALS).map(|i| i as f64 / AMPLITUDE_INTERVALS as f64)
}

/// The prescribed motion of a panel. Panel A is fixed. Panel B rotates by theta about O, and O on B
/// moves by du = R(theta/2) (a, s), so that (a, s, theta) are measured in the mean frame of (8). A
/// point of arc B at the position (X, Y) relative to O therefore moves by
///
/// u_x = X q1 - Y q2 + q3,   u_y = Y q1 + X q2 + q4,   q = (cos theta - 1, sin theta, du_x, du_y),
///
/// which is linear in the four numbers q at any rotation. These depend only on lambda.
///
/// It is the motion of panel B relative to A that corresponds to a deformation in the mean frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PanelMotion {
    /// Rotation about O (rad).
    pub theta: f64,
    /// Displacement of O on panel B (mm), in the frame of panel A.
    pub du: Point,
}

impl PanelMotion {
    /// du = R(theta/2) (a, s).
    pub(crate) fn new(deformation: &HingeDeformation) -> Self {
        Self {
            theta: deformation.theta,
            du: rotated([deformation.a, deformation.s], 0.5 * deformation.theta),
        }
    }

    /// The amplitudes (q1, q2, q3, q4) of the four control degrees of freedom.
    pub(crate) fn amplitudes(&self) -> [f64; 4] {
        // cos(theta) - 1 without cancellation.
        let q1 = -2.0 * (0.5 * self.theta).sin().powi(2);
        [q1, self.theta.sin(), self.du[0], self.du[1]]
    }

    /// (F_a, F_s, M_theta) from the resultant `force` (N) on panel B and its `moment` (N mm) about
    /// the current position of O on B. They are the gradient of the work with respect to (a, s,
    /// theta); M_theta has a contribution of the force because du rotates with theta/2.
    pub(crate) fn forces(&self, force: Point, moment: f64) -> [f64; 3] {
        let [f_a, f_s] = rotated(force, -0.5 * self.theta);
        [f_a, f_s, moment + 0.5 * (self.du[0] * force[1] - self.du[1] * force[0])]
    }
}

/// The vector (x, y) rotated counter-clockwise by `angle` (rad).
pub(crate) fn rotated([x, y]: Point, angle: f64) -> Point {
    let (sin, cos) = angle.sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_fit_the_fields_of_a_deck() {
        for x in [-1.0 / 3.0, -1.0 / 3.0 * 1e-200, 1e300 / 7.0, 0.0] {
            let text = real(x);
            assert!(text.len() <= 20, "{text}");
            assert!((text.parse::<f64>().unwrap() - x).abs() <= 1e-11 * x.abs());
        }
    }
}

#[cfg(test)]
mod driven_arc_tests {
    use super::*;
    use crate::solve::deformation_path::DeformationPath;
    use hinge::HingeDeformation;
    use proptest::prelude::*;

    #[test]
    fn amplitudes_start_at_zero_and_end_at_the_end_of_the_path() {
        let end = HingeDeformation { a: -1.0, s: 2.0, theta: 1.2 };
        let mut text = String::new();
        let path = DeformationPath::straight(end);
        write_motion(&mut text, &even_lambdas().collect::<Vec<f64>>(), &path);
        let tables: Vec<Vec<f64>> = text
            .split("*AMPLITUDE,NAME=Q")
            .skip(1)
            .map(|table| {
                let (_, numbers) = table.split_once('\n').unwrap();
                let fields = numbers.split([',', '\n']).filter(|field| !field.is_empty());
                fields.map(|field| field.parse().unwrap()).collect()
            })
            .collect();
        let end = PanelMotion::new(&end).amplitudes();
        assert_eq!(tables.len(), 4);
        for (table, end) in tables.iter().zip(end) {
            assert_eq!(table.len(), 2 * (AMPLITUDE_INTERVALS + 1));
            assert_eq!(table[..2], [0.0, 0.0]);
            assert_eq!(table[table.len() - 2], 1.0);
            assert!((table[table.len() - 1] - end).abs() < 1e-10);
        }
    }

    /// The displaced position of a point at `x` relative to O.
    fn moved(deformation: [f64; 3], x: [f64; 2]) -> [f64; 2] {
        let [q1, q2, q3, q4] = PanelMotion::new(&deformation.into()).amplitudes();
        [x[0] + x[0] * q1 - x[1] * q2 + q3, x[1] + x[1] * q1 + x[0] * q2 + q4]
    }

    proptest! {
        #[test]
        fn the_motion_is_rigid(a in -9.0..9.0f64, s in -9.0..9.0f64, theta in 0.0..1.4f64) {
            let (p, q) = ([80.0, -30.0], [-20.0, -90.0]);
            let [p1, q1] = [p, q].map(|x| moved([a, s, theta], x));
            let before = (p[0] - q[0]).hypot(p[1] - q[1]);
            prop_assert!(((p1[0] - q1[0]).hypot(p1[1] - q1[1]) - before).abs() < 1e-11);
        }

        /// Virtual work: forces . d(a, s, theta) = sum of nodal force . d(position).
        #[test]
        fn forces_are_conjugate_to_the_mean_frame(
            a in -9.0..9.0f64, s in -9.0..9.0f64, theta in 0.0..1.4f64,
            fx in -1.0..1.0f64, fy in -1.0..1.0f64
        ) {
            let x = [80.0, -30.0];
            let motion = PanelMotion::new(&HingeDeformation { a, s, theta });
            let arm = rotated(x, theta);
            let expected = motion.forces([fx, fy], arm[0] * fy - arm[1] * fx);
            for i in 0..3 {
                let h = 1e-5;
                let (mut plus, mut minus) = ([a, s, theta], [a, s, theta]);
                plus[i] += h;
                minus[i] -= h;
                let (p, q) = (moved(plus, x), moved(minus, x));
                let work = (fx * (p[0] - q[0]) + fy * (p[1] - q[1])) / (2.0 * h);
                prop_assert!((work - expected[i]).abs() < 1e-6 * (1.0 + expected[i].abs()));
            }
        }
    }
}
