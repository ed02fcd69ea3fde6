//! The window as solid elements: the plane mesh extruded to layers, with an imperfection in z.
//!
//! A perfectly flat midplane would not buckle. Therefore z is offset by t exp(-(x/w)^2 - (y/w)^2)
//! (1 - (r/r_win)^4); the offset is stress-free and zero on the arcs. The amplitude of one
//! thickness is the value that the paper measured on a cut hinge (section 4.1). The recipe sets the
//! amplitude and the widths of the bump.

use crate::{Boundary, ElementKind, Extrusion, MeshRecipe, PlaneMesh, Window, sides};
use hinge::HingeDesign;
use std::fmt::Write;
use support::vtk::{CellKind, UnstructuredGrid};
use support::{Extremes, Fault, ensure, fault, refuse};

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

// A picture of the plane mesh.

/// Picture width (px); the window's diameter fills it.
const WIDTH: f64 = 1000.0;
const MARGIN: f64 = 10.0;

/// The plane mesh as SVG: elements grey, arc A blue, arc B red, hole green. Edges are drawn as
/// quadratic curves, like the edges of the elements.
pub fn plane_mesh_svg(mesh: &WindowMesh) -> String {
    let scale = (WIDTH - 2.0 * MARGIN) / (2.0 * mesh.design.r_win);
    let height = WIDTH / 2.0 + MARGIN;
    let at = |node: usize| {
        let [x, y] = mesh.plane.nodes[node];
        [WIDTH / 2.0 + scale * x, MARGIN - scale * y]
    };
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    let mut path = |edges: &mut dyn Iterator<Item = [usize; 3]>, colour: &str, width: f64| {
        let mut d = String::new();
        for [from, to, middle] in edges {
            let ([x0, y0], [x1, y1], [xm, ym]) = (at(from), at(to), at(middle));
            // The Bezier control point whose curve passes through the mid-side node.
            let (xc, yc) = (2.0 * xm - 0.5 * (x0 + x1), 2.0 * ym - 0.5 * (y0 + y1));
            write!(d, "M{x0:.2} {y0:.2}Q{xc:.2} {yc:.2} {x1:.2} {y1:.2}")
                .expect("writing to a string cannot fail");
        }
        writeln!(
            svg,
            "<path d=\"{d}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"/>"
        )
        .expect("writing to a string cannot fail");
    };
    path(&mut mesh.plane.faces.iter().flat_map(|face| sides(face)), "#888", 0.8);
    for (boundary, colour) in
        [(Boundary::ArcA, "#1f5fbf"), (Boundary::ArcB, "#c0392b"), (Boundary::Hole, "#2e8b57")]
    {
        let edges = &mesh.plane.edges;
        let mut own = edges.iter().filter(|(of, _)| *of == boundary).map(|(_, edge)| *edge);
        path(&mut own, colour, 2.5);
    }
    svg.push_str("</svg>\n");
    svg
}

// The checks that a mesh must pass before it is solved.

/// Maximum accepted ratio of the longest to the shortest in-plane edge of an element.
const MAX_ASPECT: f64 = 40.0;
/// Maximum accepted relative error of the meshed area. A quadratic edge over an arc of 80 deg, the
/// coarsest in use, has an error of 0.3 % of the window.
pub(crate) const MAX_AREA_ERROR: f64 = 0.01;

/// Quality measures of a mesh that passed the checks.
#[derive(Clone, Copy, Debug)]
pub struct MeshQuality {
    /// Minimum over all elements of the ratio of the smallest to the largest Jacobian determinant
    /// at the Gauss points of an element; in (0, 1].
    pub jacobian_ratio: f64,
    /// Maximum ratio of the longest to the shortest in-plane edge of an element.
    pub aspect: f64,
    /// Meshed volume divided by the thickness (mm^2).
    pub area: f64,
    /// |area - exact| / exact.
    pub area_error: f64,
}

impl WindowMesh {
    /// Returns the quality measures of the mesh, or its first defect.
    pub fn quality(&self) -> Result<MeshQuality, Fault> {
        for boundary in [Boundary::ArcA, Boundary::ArcB] {
            ensure!(
                self.plane.edges.iter().any(|(of, _)| *of == boundary),
                "the mesh has no edge on {boundary:?}"
            );
        }
        let (jacobian_ratio, largest_aspect) = check_elements(&self.plane, &self.gauss_volumes)?;
        let (area, exact) = (self.volume() / self.thickness, Window(&self.design).area());
        let area_error = (area - exact).abs() / exact;
        if area_error > MAX_AREA_ERROR {
            return Err(wrong_area(area, exact));
        }
        Ok(MeshQuality { jacobian_ratio, aspect: largest_aspect, area, area_error })
    }
}

pub(crate) fn wrong_area(area: f64, exact: f64) -> Fault {
    fault!("the area of the mesh is {area} mm^2, but its shape has {exact} mm^2")
}

/// The minimum ratio of Jacobians and the maximum aspect ratio of solid elements, layers of the
/// faces of a plane mesh, or their first defect.
pub(crate) fn check_elements(
    plane: &PlaneMesh,
    gauss_volumes: &[Vec<f64>],
) -> Result<(f64, f64), Fault> {
    let mut jacobian_ratio = 1.0_f64;
    for (element, volumes) in gauss_volumes.iter().enumerate() {
        let kind = ElementKind::of(&plane.faces[element % plane.faces.len()]);
        let jacobians = (0..).zip(volumes).map(|(point, v)| v / kind.gauss_weight(point));
        let minimum = jacobians.clone().smallest();
        let maximum = jacobians.largest();
        ensure!(
            minimum > 0.0,
            "element {element} is folded: its Jacobian is {minimum} mm^3 at a Gauss point"
        );
        jacobian_ratio = jacobian_ratio.min(minimum / maximum);
    }
    let mut largest_aspect = 1.0_f64;
    for (element, face) in plane.faces.iter().enumerate() {
        let lengths = sides(face).map(|[from, to, _]| {
            let [p, q] = [from, to].map(|node| plane.nodes[node]);
            (q[0] - p[0]).hypot(q[1] - p[1])
        });
        let longest = lengths.clone().largest();
        let aspect = longest / lengths.smallest();
        if aspect > MAX_ASPECT {
            refuse!(
                "element {element} is a sliver: the ratio of its longest to its shortest edge is {aspect} > {MAX_ASPECT}"
            );
        }
        largest_aspect = largest_aspect.max(aspect);
    }
    Ok((jacobian_ratio, largest_aspect))
}
