//! The window as solid elements: the plane mesh extruded to layers, with an imperfection in z.
//!
//! A perfectly flat midplane would not buckle. Therefore z is offset by
//! t exp(-(x/w)^2 - (y/w)^2) (1 - (r/r_win)^4); the offset is stress-free and zero on the arcs. The amplitude of one
//! thickness is the value that the paper measured on a cut hinge (section 4.1). The recipe sets the amplitude and the
//! widths of the bump.

use crate::msh::{Boundary, PlaneMesh};
use crate::tier::MeshRecipe;
use hinge::HingeDesign;

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
        let layers = recipe.layers;
        let levels = Levels::new(&plane, layers);
        let nodes: Vec<_> = levels
            .nodes
            .iter()
            .map(|(level, node)| {
                let [x, y] = plane.nodes[*node];
                let z = thickness * (*level as f64 / (2 * layers) as f64 - 0.5);
                [
                    x,
                    y,
                    z + recipe.imperfection.height(&design, thickness, x, y),
                ]
            })
            .collect();
        let elements: Vec<_> = (0..layers)
            .flat_map(|layer| plane.faces.iter().map(move |face| (layer, face)))
            .map(|(layer, face)| levels.element(layer, face))
            .collect();
        let gauss_volumes = elements
            .iter()
            .map(|element| {
                let positions: Vec<_> = element.iter().map(|node| nodes[*node]).collect();
                recipe.element().gauss_volumes(&positions)
            })
            .collect();
        Self {
            design,
            thickness,
            recipe,
            arc_a: levels.through(&plane.nodes_on(Boundary::ArcA)),
            arc_b: levels.through(&plane.nodes_on(Boundary::ArcB)),
            bottom: (0..plane.nodes.len()).collect(),
            plane,
            nodes,
            elements,
            gauss_volumes,
        }
    }

    /// Volume of the meshed window (mm^3).
    pub fn volume(&self) -> f64 {
        self.gauss_volumes.iter().flatten().sum()
    }
}

/// Numbering of the extruded nodes, level by level from the bottom. Even levels contain every plane
/// node; odd levels, in the middle of the layers, contain only the corner nodes.
struct Levels {
    /// Level and plane node of each extruded node.
    nodes: Vec<(usize, usize)>,
    /// The extruded node on each level above each plane node.
    ids: Vec<Vec<Option<usize>>>,
}

impl Levels {
    fn new(plane: &PlaneMesh, layers: usize) -> Self {
        let mut is_corner = vec![false; plane.nodes.len()];
        for face in &plane.faces {
            let corners = face.len() / 2;
            face[..corners]
                .iter()
                .for_each(|node| is_corner[*node] = true);
        }
        let mut nodes = Vec::new();
        let ids = (0..=2 * layers)
            .map(|level| {
                let mut number = |node| {
                    nodes.push((level, node));
                    nodes.len() - 1
                };
                let carries = |node: &usize| level % 2 == 0 || is_corner[*node];
                (0..plane.nodes.len())
                    .map(|node| carries(&node).then(|| number(node)))
                    .collect()
            })
            .collect();
        Self { nodes, ids }
    }

    /// The element above a face: bottom and top corners, bottom and top mid-sides, verticals.
    fn element(&self, layer: usize, face: &[usize]) -> Vec<usize> {
        let (bottom, middle, top) = (2 * layer, 2 * layer + 1, 2 * layer + 2);
        let (corners, mid_sides) = face.split_at(face.len() / 2);
        [
            (bottom, corners),
            (top, corners),
            (bottom, mid_sides),
            (top, mid_sides),
            (middle, corners),
        ]
        .into_iter()
        .flat_map(|(level, nodes)| nodes.iter().map(move |node| (level, *node)))
        .map(|(level, node)| {
            self.ids[level][node].expect("corners are on all levels, mid-sides on even levels")
        })
        .collect()
    }

    /// The extruded nodes above plane nodes, on all levels.
    fn through(&self, plane: &[usize]) -> Vec<usize> {
        let on_level = |ids: &Vec<Option<usize>>| plane.iter().filter_map(|n| ids[*n]).collect();
        self.ids.iter().flat_map::<Vec<_>, _>(on_level).collect()
    }
}
