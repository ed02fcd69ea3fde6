//! The CalculiX input deck of one window solve.
//!
//! Arc B is driven along its path ([`DrivenArc`]). A path that turns back has a second step from
//! there on: an increment ends where the hinge is unloaded, which would otherwise not reach that
//! state. All output is printed in every increment, because CalculiX accumulates the total internal
//! energy between *printed* increments and it would otherwise be wrong.

use crate::{
    DeformationPath, DrivenArc, StepControl, even_lambdas, write_element, write_increments,
    write_material, write_motion, write_nodes, write_set,
};
use hinge::SheetMaterial;
use mesher::WindowMesh;
use support::add_line;

/// The deck that drives the window along its path.
pub fn deck(model: &WindowModel) -> String {
    let mut text = String::new();
    let (d, mesh) = (&mut text, model.mesh);
    let turner = mesh.nodes.len() + 1;
    let mover = turner + 1;
    write_nodes(d, &mesh.nodes);
    add_line!(d, "*NODE,NSET=CONTROL\n{turner},0.,0.,0.\n{mover},0.,0.,0.");
    let kind = mesh.recipe.element().name();
    add_line!(d, "*ELEMENT,TYPE={kind},ELSET=EALL");
    for (element, nodes) in mesh.elements.iter().enumerate() {
        write_element(d, element, nodes);
    }
    write_set(d, "NSET", "ARCA", &mesh.arc_a);
    write_set(d, "NSET", "ARCB", &mesh.arc_b);
    write_set(d, "NSET", "BOTTOM", &mesh.bottom);
    write_material(d, model.material);
    add_line!(d, "*SOLID SECTION,ELSET=EALL,MATERIAL=SHEET");
    let arc = DrivenArc { nodes: &mesh.arc_b, about: mesh.design.tip(), drivers: [turner, mover] };
    arc.write_equations(d, &mesh.nodes);
    write_motion(d, &lambdas(model.path), model.path);
    let turn = model.path.turn();
    write_step(d, model.step, turn.unwrap_or(1.0));
    add_line!(d, "*BOUNDARY\nARCA,1,3,0.\nARCB,3,3,0.\nCONTROL,3,3,0.");
    arc.write_boundary(d);
    add_line!(d, "*NODE PRINT,NSET=ARCB,FREQUENCY=1\nRF");
    let displaced = if model.print_all { "NALL" } else { "BOTTOM" };
    add_line!(d, "*NODE PRINT,NSET={displaced},FREQUENCY=1\nU");
    add_line!(d, "*EL PRINT,ELSET=EALL,TOTALS=ONLY,FREQUENCY=1\nELSE");
    add_line!(d, "*EL PRINT,ELSET=EALL,FREQUENCY=1\nPEEQ,S\n*END STEP");
    if let Some(turn) = turn {
        // Boundary conditions and output stay as in the step before. Unloading needs no shorter
        // increments than a whole path.
        let duration = 1.0 - turn;
        let greatest = (model.step.greatest / duration).min(1.0);
        write_step(d, &StepControl { greatest, ..*model.step }, duration);
        add_line!(d, "*END STEP");
    }
    text
}

/// The head of a step of the given duration.
fn write_step(d: &mut String, step: &StepControl, duration: f64) {
    add_line!(d, "*STEP,NLGEOM,INC={}\n*STATIC", step.max_increments);
    write_increments(d, step, duration)
}

/// The lambdas of the amplitude tables of a path.
fn lambdas(path: &DeformationPath) -> Vec<f64> {
    let mut lambdas: Vec<_> = even_lambdas().chain(path.corners()).collect();
    lambdas.sort_unstable_by(f64::total_cmp);
    // Entries closer than the written precision would give one time with two values.
    lambdas.dedup_by(|next, kept| *next - *kept < 1e-9);
    lambdas
}

/// A meshed window with its path, material and step control.
#[derive(Clone, Copy, Debug)]
pub struct WindowModel<'a> {
    /// The mesh of the window.
    pub mesh: &'a WindowMesh,
    /// The path along which arc B is driven.
    pub path: &'a DeformationPath,
    /// The sheet material.
    pub material: &'a SheetMaterial,
    /// The increments of the solve.
    pub step: &'a StepControl,
    /// Whether the displacements of all nodes are printed, for
    /// [`CalculiX::fields`](crate::CalculiX::fields); if not, only the displacements of the lower
    /// face are printed, which are a small part of the output.
    pub print_all: bool,
}
