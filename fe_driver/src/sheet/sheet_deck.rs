//! The CalculiX input deck of a whole sheet.
//!
//! A prescribed stroke is one linear constraint on the displacements of all loaded nodes; the
//! displacement of a control node without elements is the stroke. All output is printed in every
//! increment, because CalculiX accumulates the total internal energy between *printed* increments.

use crate::{
    GRAVITY, HeldPanel, SECONDS, STIFFNESS, SheetNodes, SheetProblem, real, write_amplitude,
    write_element, write_increments, write_material, write_nodes, write_set,
};
use mesher::{ElementKind, MeshPart, SheetMesh, SheetShape, Side};
use std::iter::zip;
use support::{Point, add_line};

/// Stiffness of the table below a node (N/mm).
const TABLE_STIFFNESS: f64 = 0.2;
/// Distance of the other ends of the springs that are the table (mm): so large that they stay
/// upright.
const TABLE_DEPTH: f64 = 1e5;
/// Height of a node at which the table releases it (mm). Exactly zero would let the first iteration
/// take the open branch.
const TABLE_KINK: f64 = 1e-5;
/// Numerical damping of the dynamic steps, near the most that the method has.
const DAMPING: f64 = -0.3;

/// A meshed sheet and all other data of its input deck.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SheetModel<'a> {
    pub problem: &'a SheetProblem,
    pub mesh: &'a SheetMesh,
    pub nodes: &'a SheetNodes,
}

/// Name of the set of nodes whose forces add up to the force of a support or of a load.
pub(crate) fn force_set(index: usize) -> String {
    format!("FORCE{index}")
}

/// Name of the set of a hinge's elements.
pub(crate) fn hinge_set(hinge: usize) -> String {
    format!("H{hinge}")
}

impl SheetModel<'_> {
    /// Duration of the step: lambda is the time over it.
    pub(crate) fn duration(&self) -> f64 {
        if self.problem.dynamic { SECONDS } else { 1.0 }
    }

    /// How many times the sheet contains what is meshed.
    pub(crate) fn copies(&self) -> f64 {
        let shape = &self.problem.shape;
        shape.thickness / shape.meshed_thickness()
    }

    /// The node whose displacement is the stroke, counted from 0.
    fn control(&self) -> usize {
        self.mesh.nodes.len()
    }

    /// The first node below the table, counted from 0.
    fn ground(&self) -> usize {
        self.control() + 1
    }

    /// The deck.
    pub(crate) fn deck(&self) -> String {
        let mut text = String::new();
        let (d, problem) = (&mut text, self.problem);
        write_nodes(d, &self.mesh.nodes);
        self.write_elements(d);
        write_set(d, "NSET", "MIDDLE", &self.mesh.middle);
        for (i, nodes) in self.nodes.held.iter().enumerate() {
            write_set(d, "NSET", &format!("HELD{i}"), nodes);
        }
        for (i, nodes) in self.nodes.measured.iter().enumerate() {
            write_set(d, "NSET", &force_set(i), nodes);
        }
        write_material(d, &problem.material);
        add_line!(d, "*DENSITY\n{}", real(problem.density()));
        add_line!(d, "*SOLID SECTION,ELSET=EALL,MATERIAL=SHEET");
        self.write_bodies(d);
        if problem.contact {
            self.write_contact(d);
        }
        self.write_table(d);
        self.write_stroke(d);
        self.write_history(d);
        add_line!(d, "*STEP,NLGEOM,INC={}", problem.step.max_increments);
        if problem.dynamic {
            add_line!(d, "*DYNAMIC,ALPHA={DAMPING}");
        } else {
            add_line!(d, "*STATIC");
        }
        write_increments(d, &problem.step, self.duration());
        self.write_boundary(d);
        self.write_loads(d);
        self.write_output(d);
        text
    }

    fn write_elements(&self, d: &mut String) {
        let mesh = self.mesh;
        for kind in [ElementKind::Brick, ElementKind::Wedge] {
            let mut of_kind = (mesh.elements.iter().enumerate())
                .filter(|(_, nodes)| ElementKind::of(nodes) == kind)
                .peekable();
            if of_kind.peek().is_some() {
                add_line!(d, "*ELEMENT,TYPE={},ELSET=EALL", kind.name());
                of_kind.for_each(|(element, nodes)| write_element(d, element, nodes));
            }
        }
        let of = |wanted: &dyn Fn(MeshPart) -> bool| -> Vec<usize> {
            let elements = 0..mesh.elements.len();
            elements.filter(|e| wanted(mesh.part(*e))).collect()
        };
        write_set(d, "ELSET", "PANELS", &of(&|part| matches!(part, MeshPart::Panel(_))));
        write_set(d, "ELSET", "WINDOWS", &of(&|part| matches!(part, MeshPart::Window(_))));
        (0..self.problem.shape.windows.len()).for_each(|hinge| {
            let elements = of(&|part| part == MeshPart::Window(hinge));
            write_set(d, "ELSET", &hinge_set(hinge), &elements)
        })
    }

    /// Rigid panels, whose springs are the set PANELS.
    fn write_bodies(&self, d: &mut String) {
        let mut first = self.mesh.elements.len();
        for body in &self.nodes.bodies {
            first = body.write(d, first, self.mesh);
        }
        if !self.nodes.bodies.is_empty() {
            // CalculiX 2.20 reads an empty line before the stiffness.
            let stiffness = STIFFNESS * self.problem.material.young * self.problem.shape.thickness;
            add_line!(d, "*SPRING,ELSET=PANELS\n\n{}", real(stiffness));
        }
    }

    /// Contact of the flanks of every cut, without friction, as stiff as a strip of the material as
    /// deep as the sheet is thick. Panels on ligaments that fold pass each other in space: they
    /// have none.
    fn write_contact(&self, d: &mut String) {
        let shape = &self.problem.shape;
        let stiffness = real(self.problem.material.young / shape.thickness);
        add_line!(
            d,
            "*SURFACE INTERACTION,NAME=FLANKS\n*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR\n{stiffness}"
        );
        for (h, window) in shape.windows.iter().enumerate() {
            let flanks = Side::BOTH.map(|side| self.mesh.flank(shape, h, side));
            if !SheetShape::bends_in_plane(window.design.w_lig, shape.thickness)
                || flanks.iter().any(Vec::is_empty)
            {
                continue;
            }
            for (name, faces) in zip(["A", "B"], flanks) {
                add_line!(d, "*SURFACE,NAME=FLANK{h}{name}");
                // The first two sides of an element are its lower and its upper face.
                faces
                    .iter()
                    .for_each(|(element, edge)| add_line!(d, "{},S{}", element + 1, edge + 3));
            }
            add_line!(
                d,
                "*CONTACT PAIR,INTERACTION=FLANKS,TYPE=SURFACE TO SURFACE\nFLANK{h}A,FLANK{h}B"
            );
        }
    }

    /// One spring below each supported node, which pushes and does not pull.
    fn write_table(&self, d: &mut String) {
        let held = self.nodes.held.concat();
        let mut first = self.mesh.elements.len();
        let supported = match self.nodes.on_table.as_slice() {
            // CalculiX 2.20 crashes in a dynamic step if the elements are few and their numbers
            // small. A spring with a large number at a node that does not move has no other effect.
            [] if self.problem.dynamic => {
                first += self.mesh.nodes.len();
                held.get(..1).unwrap_or_default()
            }
            supported => supported,
        };
        if supported.is_empty() {
            return;
        }
        let ground = self.ground();
        add_line!(d, "*NODE,NSET=GROUND");
        for (i, node) in supported.iter().enumerate() {
            let [x, y, z] = self.mesh.nodes[*node];
            let number = ground + i + 1;
            add_line!(d, "{number},{},{},{}", real(x), real(y), real(z - TABLE_DEPTH));
        }
        add_line!(d, "*ELEMENT,TYPE=SPRINGA,ELSET=TABLE");
        for (i, node) in supported.iter().enumerate() {
            write_element(d, first + i, &[ground + i, *node]);
        }
        // (force, elongation); CalculiX 2.20 reads an empty line before them.
        add_line!(
            d,
            "*SPRING,ELSET=TABLE,NONLINEAR\n\n{},{}\n0.,{}\n{},1000.",
            real(-100.0 * TABLE_STIFFNESS),
            real(TABLE_KINK - 100.0),
            real(TABLE_KINK),
            real(1e-3 * TABLE_STIFFNESS)
        );
        add_line!(d, "*BOUNDARY\nGROUND,1,3,0.")
    }

    /// The loaded degrees of freedom of nodes, counted from 1, with the direction of the stroke in
    /// them.
    fn loaded(&self) -> Vec<(usize, usize, f64)> {
        let total = self.problem.total_load();
        let pulled = zip(&self.nodes.pulled, &self.problem.pulled);
        pulled
            .flat_map(|(node, pulled)| [0, 1].map(|i| (node + 1, i + 1, pulled.force[i] / total)))
            .filter(|(.., fraction)| *fraction != 0.0)
            .collect()
    }

    fn write_stroke(&self, d: &mut String) {
        if self.problem.stroke.is_none() {
            return;
        }
        let control = self.control() + 1;
        add_line!(d, "*NODE,NSET=CONTROL\n{control},0.,0.,0.");
        let mut terms = self.loaded();
        // The first term is eliminated: the largest is the safest.
        terms.sort_by(|one, other| other.2.abs().total_cmp(&one.2.abs()));
        add_line!(d, "*EQUATION\n{}", terms.len() + 1);
        for (node, freedom, fraction) in terms {
            add_line!(d, "{node},{freedom},{}", real(fraction));
        }
        add_line!(d, "{control},1,-1.")
    }

    fn write_history(&self, d: &mut String) {
        let history = self.problem.history();
        let in_time = |pairs: Vec<Point>| {
            let duration = self.duration();
            (pairs.into_iter()).map(move |[lambda, fraction]| [duration * lambda, fraction])
        };
        write_amplitude(d, "WEIGHT", in_time(history.weight));
        write_amplitude(d, "LOADS", in_time(history.loads))
    }

    fn write_boundary(&self, d: &mut String) {
        for (i, HeldPanel { motion, .. }) in self.problem.held.iter().enumerate() {
            add_line!(d, "*BOUNDARY,AMPLITUDE=LOADS");
            for (axis, value) in motion.iter().enumerate() {
                if let Some(value) = value {
                    let freedom = axis + 1;
                    add_line!(d, "HELD{i},{freedom},{freedom},{}", real(*value));
                }
            }
            add_line!(d, "*BOUNDARY\nHELD{i},3,3,0.");
        }
        if !self.nodes.flat.is_empty() {
            add_line!(d, "*BOUNDARY");
            self.nodes.flat.iter().for_each(|node| add_line!(d, "{},3,3,0.", node + 1));
        }
        if let Some(stroke) = self.problem.stroke {
            let control = self.control() + 1;
            add_line!(d, "*BOUNDARY\n{control},2,3,0.");
            add_line!(d, "*BOUNDARY,AMPLITUDE=LOADS\n{control},1,1,{}", real(stroke));
        }
    }

    fn write_loads(&self, d: &mut String) {
        if self.problem.stroke.is_none() && !self.nodes.pulled.is_empty() {
            let total = self.problem.total_load();
            add_line!(d, "*CLOAD,AMPLITUDE=LOADS");
            for (node, freedom, fraction) in self.loaded() {
                let force = total * fraction / self.copies();
                add_line!(d, "{node},{freedom},{}", real(force));
            }
        }
        if let Some([x, y, z]) = self.problem.down {
            let gravity = real(GRAVITY);
            add_line!(d, "*DLOAD,AMPLITUDE=WEIGHT");
            add_line!(d, "EALL,GRAV,{gravity},{},{},{}", real(x), real(y), real(z));
            if !self.nodes.bodies.is_empty() {
                add_line!(d, "*CLOAD,AMPLITUDE=WEIGHT");
            }
            for body in &self.nodes.bodies {
                for (axis, force) in body.weight([x, y, z]).into_iter().enumerate() {
                    let force = force / self.copies();
                    add_line!(d, "{},{},{}", body.centre() + 1, axis + 1, real(force));
                }
            }
        }
    }

    fn write_output(&self, d: &mut String) {
        add_line!(d, "*NODE PRINT,NSET=MIDDLE,FREQUENCY=1\nU");
        for set in (0..self.nodes.measured.len()).map(force_set) {
            add_line!(d, "*NODE PRINT,NSET={set},FREQUENCY=1,TOTALS=ONLY\nRF");
        }
        let hinges = (0..self.problem.shape.windows.len()).map(hinge_set);
        for set in hinges.chain(["PANELS".to_owned()]) {
            add_line!(d, "*EL PRINT,ELSET={set},TOTALS=ONLY,FREQUENCY=1\nELSE");
        }
        if self.problem.dynamic {
            add_line!(d, "*EL PRINT,ELSET=EALL,TOTALS=ONLY,FREQUENCY=1\nELKE");
        }
        add_line!(d, "*EL PRINT,ELSET=WINDOWS,FREQUENCY=1\nPEEQ\n*END STEP")
    }
}
