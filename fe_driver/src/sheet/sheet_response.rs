//! Converts the printed increments of a sheet to its states.

use crate::{
    Damage, HingeState, PanelState, RigidMotion, SheetFrame, SheetModel, SheetState, SheetStates,
    SheetSurface,
};
use mesher::Part;
use std::collections::HashMap;

/// Freedoms of a node.
const FREEDOMS: usize = 3;

/// The states of the printed increments, in their order.
pub(crate) fn states(model: &SheetModel, frames: &[SheetFrame]) -> SheetStates {
    let panels: Vec<Vec<usize>> = (0..model.problem.shape.panels.len())
        .map(|panel| model.mesh.plane_nodes(Part::Panel(panel)))
        .collect();
    let mut windows = vec![Vec::new(); model.problem.shape.windows.len()];
    for element in 0..model.mesh.elements.len() {
        if let Part::Window(window) = model.mesh.part(element) {
            windows[window].push(element);
        }
    }
    SheetStates {
        states: frames.iter().map(|frame| model.state(frame, &panels, &windows)).collect(),
        surface: frames.last().map(|frame| model.surface(frame)),
        unknowns: FREEDOMS * model.mesh.nodes.len(),
    }
}

/// The energy of a window, or of the panels after the last (N mm).
fn energy(frame: &SheetFrame, index: usize) -> f64 {
    frame.energies[index].unwrap_or(f64::NAN)
}

impl SheetModel<'_> {
    /// `panels` are the plane nodes of each panel, `windows` the elements of each window.
    fn state(
        &self,
        frame: &SheetFrame,
        panels: &[Vec<usize>],
        windows: &[Vec<usize>],
    ) -> SheetState {
        let problem = self.problem;
        let lambda = frame.time / self.duration();
        let total = problem.total_load();
        // The stroke is c . u and the load P that is conjugate to it has the forces P c.
        let (mut stroke, mut load, mut square) = (0.0, 0.0, 0.0);
        for ((pulled, force), node) in
            (problem.pulled.iter().zip(&frame.pulls)).zip(&self.nodes.pulled)
        {
            let index = self.mesh.middle.binary_search(node);
            for axis in 0..2 {
                let fraction = pulled.force[axis] / total;
                stroke += fraction * index.map_or(0.0, |index| frame.displacements[index][axis]);
                load += fraction * force.map_or(0.0, |force| force[axis]);
                square += fraction * fraction;
            }
        }
        SheetState {
            lambda,
            fraction: problem.history().load_fraction(lambda),
            stroke,
            load_factor: if total > 0.0 { load / square / total } else { 0.0 },
            panels: panels.iter().map(|nodes| self.panel(frame, nodes)).collect(),
            hinges: (windows.iter().enumerate())
                .map(|(hinge, elements)| self.hinge(frame, hinge, elements))
                .collect(),
            panel_energy: energy(frame, windows.len()),
            kinetic_energy: frame.kinetic_energy.unwrap_or(0.0),
            support_force: frame.support_force.unwrap_or_default(),
        }
    }

    /// Positions of the middle surface above a plane node, before and after (mm).
    fn position(&self, frame: &SheetFrame, node: usize) -> [[f64; 3]; 2] {
        let before = self.mesh.nodes[self.mesh.middle[node]];
        let moved = frame.displacements[node];
        [before, [0, 1, 2].map(|i| before[i] + moved[i])]
    }

    fn panel(&self, frame: &SheetFrame, nodes: &[usize]) -> PanelState {
        let (before, after): (Vec<_>, Vec<_>) =
            nodes.iter().map(|node| self.position(frame, *node).into()).unzip();
        let motion = RigidMotion::fitted(&before, &after);
        let bending = std::iter::zip(&before, &after)
            .map(|(p, q)| motion.left(*p, *q)[2].abs())
            .fold(0.0, f64::max);
        let heights = || after.iter().map(|point| point[2]);
        PanelState {
            centre: motion.from,
            shift: [0, 1, 2].map(|i| motion.to[i] - motion.from[i]),
            rotation: motion.rotation,
            bending,
            z: [
                heights().fold(f64::INFINITY, f64::min),
                heights().fold(f64::NEG_INFINITY, f64::max),
            ],
        }
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
        let damage = Damage::new(points.collect(), design, shape.thickness, material);
        HingeState { energy: energy(frame, hinge), d: damage.d, d_peak: damage.d_peak }
    }

    fn surface(&self, frame: &SheetFrame) -> SheetSurface {
        let mut surface = SheetSurface::default();
        let mut indices = HashMap::new();
        let (faces, panels) = (&self.mesh.plane.faces, self.problem.shape.panels.len());
        for (face, part) in std::iter::zip(faces, &self.mesh.parts) {
            let corners = face[..face.len() / 2].iter().map(|node| {
                *indices.entry(*node).or_insert_with(|| {
                    let [before, _] = self.position(frame, *node);
                    surface.points.push(before);
                    surface.displacements.push(frame.displacements[*node]);
                    surface.points.len() - 1
                })
            });
            let corners = corners.collect();
            surface.faces.push(corners);
            surface.parts.push(match part {
                Part::Panel(panel) => *panel,
                Part::Window(window) => panels + window,
            });
        }
        surface.plastic_strain = (0..faces.len())
            .map(|face| {
                let above = (face..self.mesh.elements.len()).step_by(faces.len());
                let strains = above.flat_map(|element| frame.peeq[element].iter().copied());
                strains.fold(0.0, f64::max)
            })
            .collect();
        surface
    }
}
