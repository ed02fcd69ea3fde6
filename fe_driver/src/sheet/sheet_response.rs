//! Converts the printed increments of a sheet to its states.

use crate::{
    Damage, HingeState, PanelState, SheetFrame, SheetModel, SheetState, SheetStates, SheetSurface,
};
use faer::Side;
use faer::mat::Mat;
use mesher::MeshPart;
use std::array::from_fn;
use std::iter::zip;
use support::Extremes;

/// Freedoms of a node.
const FREEDOMS: usize = 3;

/// The states of the printed increments, in their order.
pub(crate) fn states(model: &SheetModel, frames: &[SheetFrame]) -> SheetStates {
    let mut windows = vec![Vec::new(); model.problem.shape.windows.len()];
    for element in 0..model.mesh.elements.len() {
        if let MeshPart::Window(window) = model.mesh.part(element) {
            windows[window].push(element);
        }
    }
    SheetStates {
        states: frames.iter().map(|frame| model.state(frame, &windows)).collect(),
        surface: frames.last().map(|frame| model.surface(frame)),
        unknowns: FREEDOMS * model.mesh.nodes.len(),
    }
}

impl SheetModel<'_> {
    /// The energy of a window, or of the panels after the last (N mm).
    fn energy(&self, frame: &SheetFrame, index: usize) -> f64 {
        self.copies() * frame.energies[index].unwrap_or(f64::NAN)
    }

    /// `windows` are the elements of each window.
    fn state(&self, frame: &SheetFrame, windows: &[Vec<usize>]) -> SheetState {
        let problem = self.problem;
        let lambda = frame.time / self.duration();
        let fraction = problem.history().load_fraction(lambda);
        let total = problem.total_load();
        let panels: Vec<_> =
            (0..problem.shape.panels.len()).map(|k| self.panel(frame, k)).collect();
        // The stroke is c . u and the load P that is conjugate to it has the forces P c.
        let (mut stroke, mut load, mut square) = (0.0, 0.0, 0.0);
        for (i, pulled) in problem.pulled.iter().enumerate() {
            let (at, moved) = (pulled.at, panels[pulled.panel].moved(pulled.at));
            let force = self.force(frame, problem.held.len() + i, pulled.panel);
            for axis in 0..2 {
                let part = pulled.force[axis] / total;
                stroke += part * (moved[axis] - at[axis]);
                load += part * force[axis];
                square += part * part;
            }
        }
        let supports = problem.held.iter().enumerate();
        let support_forces = supports.map(|(i, held)| {
            let [x, y, z] = self.force(frame, i, held.panel);
            let [holds_x, holds_y] = held.motion.map(|motion| motion.is_some());
            [if holds_x { x } else { 0.0 }, if holds_y { y } else { 0.0 }, z]
        });
        SheetState {
            lambda,
            fraction,
            stroke: problem.stroke.map_or(stroke, |end| fraction * end),
            load_factor: if total > 0.0 { load / square / total } else { 0.0 },
            panels,
            hinges: (windows.iter().enumerate())
                .map(|(hinge, elements)| self.hinge(frame, hinge, elements))
                .collect(),
            panel_energy: self.energy(frame, windows.len()),
            kinetic_energy: frame.kinetic_energy.unwrap_or(0.0),
            support_forces: support_forces.collect(),
        }
    }

    /// The force on a panel at a support or a load (N), without its weight if it is rigid.
    fn force(&self, frame: &SheetFrame, index: usize, panel: usize) -> [f64; 3] {
        let problem = self.problem;
        let on = problem.history().weight_fraction(frame.time / self.duration());
        let body = self.nodes.bodies.get(panel);
        let weight = body.map_or([0.0; 3], |body| body.weight(problem.down.unwrap_or_default()));
        let force = frame.forces[index].unwrap_or([f64::NAN; 3]);
        [0, 1, 2].map(|i| self.copies() * force[i] - on * weight[i])
    }

    /// Positions of the middle surface above a plane node, before and after (mm).
    fn position(&self, frame: &SheetFrame, node: usize) -> [[f64; 3]; 2] {
        let before = self.mesh.nodes[self.mesh.middle[node]];
        let moved = frame.displacements[node];
        [before, [0, 1, 2].map(|i| before[i] + moved[i])]
    }

    fn panel(&self, frame: &SheetFrame, panel: usize) -> PanelState {
        let (before, after): (Vec<_>, Vec<_>) =
            self.mesh.panels[panel].iter().map(|node| self.position(frame, *node).into()).unzip();
        let motion = RigidMotion::fitted(&before, &after);
        let bending = zip(&before, &after).map(|(p, q)| motion.left(*p, *q)[2].abs()).largest();
        let mut state = PanelState {
            centre: motion.from,
            shift: [0, 1, 2].map(|i| motion.to[i] - motion.from[i]),
            rotation: motion.rotation,
            bending,
            z: [0.0; 2],
        };
        let heights = self.problem.shape.outline(panel).into_iter().map(|at| state.moved(at)[2]);
        let [mut low, mut high] = [f64::INFINITY, f64::NEG_INFINITY];
        heights.for_each(|z| (low, high) = (low.min(z), high.max(z)));
        state.z = [low, high];
        state
    }

    /// `elements` are the elements of the window of the hinge.
    fn hinge(&self, frame: &SheetFrame, hinge: usize, elements: &[usize]) -> HingeState {
        let shape = &self.problem.shape;
        let points = elements.iter().flat_map(|element| {
            let strains = frame.peeq[*element].iter().copied();
            strains.zip(self.mesh.gauss_volumes[*element].iter().copied())
        });
        let design = &shape.windows[hinge].design;
        let material = &self.problem.material;
        let damage = Damage::new(points.collect(), design, shape.meshed_thickness(), material);
        HingeState { energy: self.energy(frame, hinge), d: damage.d, d_peak: damage.d_peak }
    }

    fn surface(&self, frame: &SheetFrame) -> SheetSurface {
        let (faces, panels) = (&self.mesh.plane.faces, self.problem.shape.panels.len());
        let part = |part: &MeshPart| match part {
            MeshPart::Panel(panel) => *panel,
            MeshPart::Window(window) => panels + window,
        };
        let strain = |face| {
            let above = (face..self.mesh.elements.len()).step_by(faces.len());
            let strains = above.flat_map(|element| frame.peeq[element].iter().copied());
            strains.largest()
        };
        let mut surface = SheetSurface {
            points: self.mesh.middle.iter().map(|node| self.mesh.nodes[*node]).collect(),
            displacements: frame.displacements.clone(),
            faces: faces.iter().map(|face| face[..face.len() / 2].to_vec()).collect(),
            parts: self.mesh.parts.iter().map(part).collect(),
            plastic_strain: (0..faces.len()).map(strain).collect(),
        };
        for panel in 0..self.nodes.bodies.len() {
            self.add_rigid_panel(&mut surface, frame, panel);
        }
        surface
    }

    /// Adds the outline of a rigid panel as one face.
    fn add_rigid_panel(&self, surface: &mut SheetSurface, frame: &SheetFrame, panel: usize) {
        let (state, outline) = (self.panel(frame, panel), self.problem.shape.outline(panel));
        let first = surface.points.len();
        for [x, y] in outline {
            let moved = state.moved([x, y]);
            surface.points.push([x, y, 0.0]);
            surface.displacements.push([moved[0] - x, moved[1] - y, moved[2]]);
        }
        surface.faces.push((first..surface.points.len()).collect());
        surface.parts.push(panel);
        surface.plastic_strain.push(0.0);
    }
}

// The rigid motion in space that points follow best, in the mean of squares.
//
// The rotation is the quaternion that is the eigenvector of the largest eigenvalue of a symmetric
// 4 x 4 matrix (B. K. P. Horn, J. Opt. Soc. Am. A 4, 629, 1987). It is defined for points of one
// plane, too, if they are not on one line.

/// A rigid motion, with the means of the points before and after it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RigidMotion {
    /// Mean of the points before (mm).
    pub from: [f64; 3],
    /// Mean of the points after (mm).
    pub to: [f64; 3],
    /// Rotation matrix, row by row.
    pub rotation: [[f64; 3]; 3],
}

impl RigidMotion {
    /// The motion from the points `before` to the points `after`.
    pub(crate) fn fitted(before: &[[f64; 3]], after: &[[f64; 3]]) -> Self {
        let (from, to) = (mean(before), mean(after));
        let mut s = [[0.0; 3]; 3];
        for (p, q) in zip(before, after) {
            for i in 0..3 {
                for j in 0..3 {
                    s[i][j] += (p[i] - from[i]) * (q[j] - to[j]);
                }
            }
        }
        Self { from, to, rotation: rotation(s) }
    }

    /// The displacement of a point relative to the rigid body: the position of the point less its
    /// position on the body, in the frame of the body.
    pub(crate) fn left(&self, before: [f64; 3], after: [f64; 3]) -> [f64; 3] {
        let r = &self.rotation;
        from_fn(|i| {
            let turned_back: f64 = (0..3).map(|j| r[j][i] * (after[j] - self.to[j])).sum();
            turned_back - (before[i] - self.from[i])
        })
    }
}

fn mean(points: &[[f64; 3]]) -> [f64; 3] {
    let count = points.len().max(1) as f64;
    from_fn(|i| points.iter().map(|point| point[i]).sum::<f64>() / count)
}

/// The rotation R that maximises the trace of R s, for s the sum of the products of coordinates
/// before and after.
fn rotation(s: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let trace = s[0][0] + s[1][1] + s[2][2];
    let twist = [s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]];
    let matrix = Mat::from_fn(4, 4, |i, j| match (i, j) {
        (0, 0) => trace,
        (0, k) | (k, 0) => twist[k - 1],
        (i, j) => {
            let (i, j) = (i - 1, j - 1);
            s[i][j] + s[j][i] - if i == j { trace } else { 0.0 }
        }
    });
    // Points that all fall together have every rotation.
    let Ok(eigen) = matrix.self_adjoint_eigen(Side::Lower) else {
        return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    };
    // Eigenvalues increase.
    let [w, x, y, z] = [0, 1, 2, 3].map(|i| eigen.U()[(i, 3)]);
    [
        [w * w + x * x - y * y - z * z, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The rotation by the vector v, by Rodrigues' formula.
    fn about(v: [f64; 3]) -> [[f64; 3]; 3] {
        let angle = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let [x, y, z] = v.map(|c| if angle > 0.0 { c / angle } else { 0.0 });
        let (sin, cos) = angle.sin_cos();
        let rest = 1.0 - cos;
        [
            [cos + x * x * rest, x * y * rest - z * sin, x * z * rest + y * sin],
            [y * x * rest + z * sin, cos + y * y * rest, y * z * rest - x * sin],
            [z * x * rest - y * sin, z * y * rest + x * sin, cos + z * z * rest],
        ]
    }

    proptest! {
        /// Also for the points of a plane, as a panel's are.
        #[test]
        fn a_rigid_motion_is_found(
            v in proptest::array::uniform3(-1.7..1.7f64),
            shift in proptest::array::uniform3(-50.0..50.0f64),
            height in prop_oneof![Just(0.0), Just(7.0)],
        ) {
            let before = [[0.0, 0.0, 0.0], [70.0, 3.0, 0.0], [65.0, 60.0, 0.0], [-2.0, 40.0, height]];
            let r = about(v);
            let after = before.map(|p| -> [f64; 3] {
                std::array::from_fn(|i| shift[i] + (0..3).map(|j| r[i][j] * p[j]).sum::<f64>())
            });
            let found = RigidMotion::fitted(&before, &after);
            let entries = std::iter::zip(found.rotation.as_flattened(), r.as_flattened());
            for (found, expected) in entries {
                prop_assert!((found - expected).abs() < 1e-10);
            }
            for (p, q) in std::iter::zip(before, after) {
                prop_assert!(found.left(p, q).iter().all(|x| x.abs() < 1e-9));
            }
        }
    }

    #[test]
    fn bending_is_left_along_the_normal() {
        let before = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
        // Warped: two opposite corners up, the others down, in a plane that has turned upright.
        let after = [[0.0, -0.1, 0.0], [2.0, 0.1, 0.0], [2.0, -0.1, 2.0], [0.0, 0.1, 2.0]];
        let found = RigidMotion::fitted(&before, &after);
        for (p, q) in std::iter::zip(before, after) {
            let left = found.left(p, q);
            assert!(left[0].abs() < 1e-12 && left[1].abs() < 1e-12, "{left:?}");
            assert!((left[2].abs() - 0.1).abs() < 1e-12, "{left:?}");
        }
    }
}
