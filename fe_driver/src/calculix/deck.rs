//! The CalculiX input deck of one window solve.
//!
//! Arc B is driven along its path ([`DrivenArc`]). A path that turns back has a second step from
//! there on: an increment ends where the hinge is unloaded, which would otherwise not reach that
//! state. All output is printed in every increment, because CalculiX accumulates the total internal
//! energy between *printed* increments and it would otherwise be wrong.

use crate::{
    DeformationPath, DrivenArc, OutputFrame, StepControl, even_lambdas, write_element,
    write_increments, write_material, write_motion, write_nodes, write_set,
};
use hinge::SheetMaterial;
use mesher::{WindowMesh, vtk_grid};
use std::iter::zip;
use support::vtk::{Field, UnstructuredGrid};
use support::{Extremes, add_line};

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

// Displacement, plastic strain and stress of a solved window as a VTK grid.
//
// CalculiX prints strain and stress at the Gauss points. A cell of the grid has their means by
// volume, and the maximum of the plastic strain; nothing is extrapolated to the nodes.

/// Places of VTK's components XX, YY, ZZ, XY, YZ, XZ in a printed stress (xx, yy, zz, xy, xz, yz).
const VTK_ORDER: [usize; 6] = [0, 1, 2, 3, 5, 4];

impl WindowModel<'_> {
    /// The undeformed window with the fields of an increment that printed the displacements of all
    /// nodes.
    pub(crate) fn grid(&self, frame: &OutputFrame) -> UnstructuredGrid {
        let points = self.mesh.recipe.element().gauss_points();
        let strains = || frame.peeq.chunks(points);
        let volumes = || self.mesh.gauss_volumes.iter();
        let mean = |values: &dyn Fn(usize) -> f64, volumes: &[f64]| {
            let sum: f64 = volumes.iter().enumerate().map(|(i, volume)| values(i) * volume).sum();
            sum / volumes.iter().sum::<f64>()
        };
        let plastic: Vec<f64> = zip(strains(), volumes())
            .map(|(strain, volumes)| mean(&|i| strain[i], volumes))
            .collect();
        let stresses: Vec<[f64; 6]> = zip(frame.stress.chunks(points), volumes())
            .map(|(stress, volumes)| VTK_ORDER.map(|c| mean(&|i| stress[i][c], volumes)))
            .collect();
        let most = || strains().map(|strain| strain.iter().copied().largest());
        let fracture = self.material.fracture_strain;
        let displacements = frame.displacements.iter().copied();
        UnstructuredGrid {
            point_data: vec![Field::vector("displacement (mm)", displacements)],
            cell_data: vec![
                Field::scalar("plastic strain", plastic.iter().copied()),
                Field::scalar("plastic strain, maximum", most()),
                Field::scalar("local D", plastic.iter().map(|strain| strain / fracture)),
                Field::scalar("local D, maximum", most().map(|strain| strain / fracture)),
                Field::vector("stress (MPa)", stresses.iter().copied()),
                Field::scalar("von Mises stress (MPa)", stresses.iter().map(von_mises)),
            ],
            ..vtk_grid(self.mesh)
        }
    }
}

/// The equivalent stress of (xx, yy, zz, xy, yz, xz).
fn von_mises([xx, yy, zz, xy, yz, xz]: &[f64; 6]) -> f64 {
    let normal = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
    (0.5 * normal + 3.0 * (xy * xy + yz * yz + xz * xz)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniaxial_and_shear_stress_have_their_equivalents() {
        assert_eq!(von_mises(&[3.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 3.0);
        assert!((von_mises(&[0.0, 0.0, 0.0, 0.0, 2.0, 0.0]) - 12.0_f64.sqrt()).abs() < 1e-15);
        assert_eq!(von_mises(&[5.0, 5.0, 5.0, 0.0, 0.0, 0.0]), 0.0);
    }
}
