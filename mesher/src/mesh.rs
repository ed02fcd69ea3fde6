//! The window as solid elements: the plane mesh extruded to layers, with an imperfection in z.
//!
//! A perfectly flat midplane would not buckle. Therefore z is offset by t exp(-(x/w)^2 - (y/w)^2)
//! (1 - (r/r_win)^4); the offset is stress-free and zero on the arcs. The amplitude of one
//! thickness is the value that the paper measured on a cut hinge (section 4.1). The recipe sets the
//! amplitude and the widths of the bump.

use crate::{Boundary, ElementKind, Extrusion, MeshRecipe, PlaneMesh};
use hinge::HingeDesign;
use support::vtk::{CellKind, UnstructuredGrid};

/// A window of solid elements of one kind; indices count from 0.
#[derive(Clone, Debug)]
pub struct WindowMesh {
    /// The hinge design whose window is meshed.
    pub design: HingeDesign,
    /// Sheet thickness (mm).
    pub thickness: f64,
    /// The recipe of the mesh.
    pub recipe: MeshRecipe,
    /// The plane mesh that was extruded.
    pub plane: PlaneMesh,
    /// Node positions in the hinge frame, imperfection included (mm).
    pub nodes: Vec<[f64; 3]>,
    /// Elements in the node order of their [`ElementKind`](crate::ElementKind), layer by layer.
    pub elements: Vec<Vec<usize>>,
    /// Nodes of the fixed arc, through the thickness.
    pub arc_a: Vec<usize>,
    /// Nodes of the driven arc, through the thickness.
    pub arc_b: Vec<usize>,
    /// Nodes of the sheet's lower face.
    pub bottom: Vec<usize>,
    /// Undeformed volume of each Gauss point of each element (mm^3).
    pub gauss_volumes: Vec<Vec<f64>>,
}

impl WindowMesh {
    /// Extrudes a plane mesh to the layers of `recipe` through z in [-t/2, t/2].
    pub(crate) fn extrude(
        design: HingeDesign,
        thickness: f64,
        recipe: MeshRecipe,
        plane: PlaneMesh,
    ) -> Self {
        let bump = |[x, y]: [f64; 2]| recipe.imperfection.height(&design, thickness, x, y);
        let solid =
            Extrusion::new(&plane, thickness, recipe.layers, |node| bump(plane.nodes[node]));
        Self {
            design,
            thickness,
            recipe,
            arc_a: solid.levels.through(&plane.nodes_on(Boundary::ArcA)),
            arc_b: solid.levels.through(&plane.nodes_on(Boundary::ArcB)),
            bottom: (0..plane.nodes.len()).collect(),
            plane,
            nodes: solid.nodes,
            elements: solid.elements,
            gauss_volumes: solid.gauss_volumes,
        }
    }

    /// Volume of the meshed window (mm^3).
    pub fn volume(&self) -> f64 {
        self.gauss_volumes.iter().flatten().sum()
    }
}

/// The undeformed window as a VTK grid, without data. VTK orders the nodes of its quadratic
/// hexahedron and wedge as CalculiX orders the nodes of C3D20R and C3D15.
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
