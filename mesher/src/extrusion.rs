//! A plane mesh extruded to layers of solid elements.

use crate::{ElementKind, PlaneMesh};

/// Solid elements above the faces of a plane mesh; indices count from 0.
#[derive(Debug)]
pub(crate) struct Extrusion {
    /// Node positions (mm).
    pub nodes: Vec<[f64; 3]>,
    /// Elements in the node order of their kind, layer by layer in the order of the faces.
    pub elements: Vec<Vec<usize>>,
    /// Undeformed volume of each Gauss point of each element (mm^3).
    pub gauss_volumes: Vec<Vec<f64>>,
    pub levels: NodeLevels,
}

impl Extrusion {
    /// Layers through z in [-t/2, t/2], offset by a height (mm) at every plane node.
    pub(crate) fn new(
        plane: &PlaneMesh,
        thickness: f64,
        layers: usize,
        height: impl Fn(usize) -> f64,
    ) -> Self {
        let levels = NodeLevels::new(plane, layers);
        let nodes: Vec<_> = levels
            .nodes
            .iter()
            .map(|(level, node)| {
                let [x, y] = plane.nodes[*node];
                let z = thickness * (*level as f64 / (2 * layers) as f64 - 0.5);
                [x, y, z + height(*node)]
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
                ElementKind::of(element).gauss_volumes(&positions)
            })
            .collect();
        Self { nodes, elements, gauss_volumes, levels }
    }
}

/// Numbering of the extruded nodes, level by level from the bottom. Even levels contain every plane
/// node; odd levels, in the middle of the layers, contain only the corner nodes.
#[derive(Debug)]
pub(crate) struct NodeLevels {
    /// Level and plane node of each extruded node.
    nodes: Vec<(usize, usize)>,
    /// The extruded node on each level above each plane node.
    ids: Vec<Vec<Option<usize>>>,
}

impl NodeLevels {
    fn new(plane: &PlaneMesh, layers: usize) -> Self {
        let mut is_corner = vec![false; plane.nodes.len()];
        for face in &plane.faces {
            let corners = face.len() / 2;
            face[..corners].iter().for_each(|node| is_corner[*node] = true);
        }
        let mut nodes = Vec::new();
        let ids = (0..=2 * layers)
            .map(|level| {
                let mut number = |node| {
                    nodes.push((level, node));
                    nodes.len() - 1
                };
                let carries = |node: &usize| level % 2 == 0 || is_corner[*node];
                (0..plane.nodes.len()).map(|node| carries(&node).then(|| number(node))).collect()
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

    /// The nodes above plane nodes, on all levels.
    pub(crate) fn through(&self, plane: &[usize]) -> Vec<usize> {
        let on_level = |ids: &Vec<Option<usize>>| plane.iter().filter_map(|n| ids[*n]).collect();
        let levels = self.ids.iter();
        levels.flat_map::<Vec<_>, _>(on_level).collect()
    }

    /// The nodes above all plane nodes on an even level, counted from the bottom.
    pub(crate) fn level(&self, level: usize) -> Vec<usize> {
        self.ids[level].iter().flatten().copied().collect()
    }
}
