//! Converts the printed increments of a sheet to its states.

use crate::{
    Damage, HingeState, PanelState, RigidMotion, SheetFrame, SheetModel, SheetState, SheetStates,
    SheetSurface,
};
use mesher::Part;

/// Freedoms of a node.
const FREEDOMS: usize = 3;

/// The states of the printed increments, in their order.
pub(crate) fn states(model: &SheetModel, frames: &[SheetFrame]) -> SheetStates {
    let mut windows = vec![Vec::new(); model.problem.shape.windows.len()];
    for element in 0..model.mesh.elements.len() {
        if let Part::Window(window) = model.mesh.part(element) {
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
        let bending = std::iter::zip(&before, &after)
            .map(|(p, q)| motion.left(*p, *q)[2].abs())
            .fold(0.0, f64::max);
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
        let part = |part: &Part| match part {
            Part::Panel(panel) => *panel,
            Part::Window(window) => panels + window,
        };
        let strain = |face| {
            let above = (face..self.mesh.elements.len()).step_by(faces.len());
            let strains = above.flat_map(|element| frame.peeq[element].iter().copied());
            strains.fold(0.0, f64::max)
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
