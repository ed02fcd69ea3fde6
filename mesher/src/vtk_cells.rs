//! The mesh of a window as a VTK grid.
//!
//! VTK orders the nodes of its quadratic hexahedron and wedge as CalculiX orders the nodes of
//! C3D20R and C3D15: lower corners, upper corners, middles of the lower, upper and vertical edges.

use crate::{ElementKind, WindowMesh};
use support::vtk::{CellKind, UnstructuredGrid};

/// The undeformed window, without data.
pub fn vtk_grid(mesh: &WindowMesh) -> UnstructuredGrid {
    UnstructuredGrid {
        points: mesh.nodes.clone(),
        kind: match mesh.recipe.element() {
            ElementKind::Brick => CellKind::QuadraticHexahedron,
            ElementKind::Wedge => CellKind::QuadraticWedge,
        },
        cells: mesh.elements.clone(),
        point_data: Vec::new(),
        cell_data: Vec::new(),
    }
}
