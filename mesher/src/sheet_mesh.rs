//! A sheet as solid elements: its plane mesh extruded to layers, with a bump at every hinge.

use crate::{
    Extrusion, Imperfection, MAX_AREA_ERROR, NodeLevels, Panels, PlacedWindow, PlaneMesh,
    SheetShape, Side, Window, check_elements, cross, dot, minus, unit, wrong_area,
};
use std::iter::zip;
use support::{Extremes, Fault, Point};

/// Largest distance of a node from the arc of its window, over r_win.
const ON_RIM: f64 = 1e-6;
/// Largest distance of a node on a straight edge from it (mm).
const ON_EDGE: f64 = 1e-6;
/// Distance from the foot of a ligament, over w_lig, up to which a flank belongs to the ligament
/// and its hole.
const AT_LIGAMENT: f64 = 2.0;

/// What a face or an element of a sheet belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MeshPart {
    /// The part of a panel outside of all windows.
    Panel(usize),
    /// A window.
    Window(usize),
}

/// A sheet of solid elements; indices count from 0.
#[derive(Debug)]
pub struct SheetMesh {
    /// The plane mesh that was extruded.
    pub plane: PlaneMesh,
    /// The part of each face, and of each element of each layer above it.
    pub parts: Vec<MeshPart>,
    /// The plane nodes of each panel in increasing order; of a rigid panel on the arcs of its
    /// windows.
    pub panels: Vec<Vec<usize>>,
    /// Node positions, bumps included (mm).
    pub nodes: Vec<[f64; 3]>,
    /// Elements in the node order of their [`ElementKind`](crate::ElementKind), layer by layer in
    /// the order of the faces.
    pub elements: Vec<Vec<usize>>,
    /// The nodes in the middle of the thickness above the plane nodes, in their order.
    pub middle: Vec<usize>,
    /// The nodes of the lower face, in the order of the plane nodes.
    pub bottom: Vec<usize>,
    /// Undeformed volume of each Gauss point of each element (mm^3).
    pub gauss_volumes: Vec<Vec<f64>>,
    levels: NodeLevels,
}

impl SheetMesh {
    pub(crate) fn new(shape: &SheetShape, plane: PlaneMesh) -> Result<Self, Fault> {
        let panels = shape.panels.len();
        let parts: Vec<MeshPart> = (plane.surfaces.iter())
            .map(|tag| match (*tag as usize).saturating_sub(1) {
                panel if panel < panels => MeshPart::Panel(panel),
                window => MeshPart::Window(window - panels),
            })
            .collect();
        let mut height = vec![0.0; plane.nodes.len()];
        for (face, part) in zip(&plane.faces, &parts) {
            if let MeshPart::Window(window) = part {
                let window = &shape.windows[*window];
                for node in face {
                    height[*node] = window.height(shape.thickness, plane.nodes[*node]);
                }
            }
        }
        let meshed = shape.meshed_thickness();
        let raised = 0.5 * (shape.thickness - meshed);
        let solid = Extrusion::new(&plane, meshed, shape.layers, |node| raised + height[node]);
        check_elements(&plane, &solid.gauss_volumes)?;
        let volume: f64 = solid.gauss_volumes.iter().flatten().sum();
        let (area, exact) = (volume / meshed, shape.area());
        if (area - exact).abs() > MAX_AREA_ERROR * exact {
            return Err(wrong_area(area, exact));
        }
        let mut mesh = Self {
            panels: Vec::new(),
            middle: solid.levels.level(if shape.half { 0 } else { shape.layers }),
            bottom: solid.levels.level(0),
            nodes: solid.nodes,
            elements: solid.elements,
            gauss_volumes: solid.gauss_volumes,
            levels: solid.levels,
            plane,
            parts,
        };
        mesh.panels = (0..panels)
            .map(|panel| match shape.model {
                Panels::Rigid => mesh.arcs(shape, panel),
                Panels::Meshed => mesh.plane_nodes(MeshPart::Panel(panel)),
            })
            .collect();
        Ok(mesh)
    }

    /// The part of an element.
    pub fn part(&self, element: usize) -> MeshPart {
        self.parts[element % self.parts.len()]
    }

    /// The plane nodes of a part, in increasing order.
    pub fn plane_nodes(&self, part: MeshPart) -> Vec<usize> {
        let faces = zip(&self.plane.faces, &self.parts);
        let mut nodes: Vec<usize> = faces
            .filter(|(_, of)| **of == part)
            .flat_map(|(face, _)| face.iter().copied())
            .collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// The nodes above plane nodes, through the thickness.
    pub fn through(&self, plane: &[usize]) -> Vec<usize> {
        self.levels.through(plane)
    }

    /// The plane nodes on the arcs of the windows of a panel, in increasing order.
    fn arcs(&self, shape: &SheetShape, panel: usize) -> Vec<usize> {
        let mut nodes = Vec::new();
        for (number, PlacedWindow { design, frame, panels, .. }) in shape.windows.iter().enumerate()
        {
            let sides = zip(Side::BOTH, panels).filter(|(_, (of, _))| *of == panel);
            for (side, _) in sides {
                nodes.extend(self.plane_nodes(MeshPart::Window(number)).into_iter().filter(
                    |node| {
                        let local = frame.local(self.plane.nodes[*node]);
                        let [x, y] = local;
                        let across = dot(minus(local, design.tip()), Window(design).normal());
                        across * side.sign() > 0.0
                            && (x.hypot(y) / design.r_win - 1.0).abs() < ON_RIM
                    },
                ));
            }
        }
        nodes.sort_unstable();
        nodes
    }

    /// The side faces of elements that are the flank of a window's main cut on one of its panels,
    /// without those at ligaments and holes: (element, edge of its lower face).
    pub fn flank(&self, shape: &SheetShape, window: usize, side: Side) -> Vec<(usize, usize)> {
        let [from, to] = shape.flank(window, side);
        let (direction, length) = (unit(from, to), dot(minus(to, from), unit(from, to)));
        let on_flank = |node: &usize| {
            let point = self.plane.nodes[*node];
            let arm = minus(point, from);
            let at = dot(arm, direction);
            let at_ligament = |window: &PlacedWindow| {
                let [x, y] = window.frame.local(point);
                x.hypot(y) < AT_LIGAMENT * window.design.w_lig
            };
            cross(direction, arm).abs() < ON_EDGE
                && (-ON_EDGE..length + ON_EDGE).contains(&at)
                && !shape.windows.iter().any(at_ligament)
        };
        let of_face = |nodes: &Vec<usize>| {
            let on: Vec<bool> = nodes[..nodes.len() / 2].iter().map(on_flank).collect();
            (0..on.len()).find(|edge| on[*edge] && on[(edge + 1) % on.len()])
        };
        let edges: Vec<Option<usize>> = self.plane.faces.iter().map(of_face).collect();
        (0..self.elements.len())
            .filter_map(|element| Some((element, edges[element % edges.len()]?)))
            .collect()
    }

    /// The corner node of a part's faces that is nearest to a point.
    pub fn nearest(&self, part: MeshPart, point: Point) -> Option<usize> {
        let distance = |node: &usize| {
            let [x, y] = minus(self.plane.nodes[*node], point);
            x.hypot(y)
        };
        let faces = zip(&self.plane.faces, &self.parts);
        let corners = faces
            .filter(|(_, of)| **of == part)
            .flat_map(|(face, _)| face[..face.len() / 2].iter().copied());
        corners.smallest_by(distance)
    }
}

impl PlacedWindow {
    /// Height (mm) of the bump at a point of the window.
    fn height(&self, thickness: f64, point: Point) -> f64 {
        let [x, y] = self.frame.local(point);
        let bump = Imperfection { amplitude: self.bump, widths: Imperfection::WIDTHS };
        bump.height(&self.design, thickness, x, y)
    }
}

impl SheetShape {
    /// The finished edge of a panel along the main cut of a window.
    fn flank(&self, window: usize, side: Side) -> [Point; 2] {
        let [a, b] = self.windows[window].panels;
        // Edges are counted by the corner at which they begin, counter-clockwise: the flank ends at
        // the corner of A.
        let (panel, edge) = match side {
            Side::A => (a.0, self.panels[a.0].edge_before(a.1)),
            Side::B => b,
        };
        self.panels[panel].edge(edge)
    }

    /// Area of the mesh (mm^2): windows, and panels that are meshed.
    fn area(&self) -> f64 {
        let windows = self.windows.iter().map(|placed| Window(&placed.design).area());
        let panels = match self.model {
            Panels::Rigid => 0..0,
            Panels::Meshed => 0..self.panels.len(),
        };
        windows.chain(panels.map(|panel| self.rest(panel)[0])).sum()
    }

    /// A panel outside of its windows: its area (mm^2) and its centroid (mm).
    pub fn rest(&self, panel: usize) -> [f64; 3] {
        let outline = self.outline(panel);
        let next = outline.iter().cycle().skip(1);
        let mut sums = [0.0; 3];
        for (from, to) in zip(&outline, next) {
            let twice = cross(*from, *to);
            sums[0] += 0.5 * twice;
            (0..2).for_each(|i| sums[i + 1] += twice * (from[i] + to[i]) / 6.0);
        }
        [sums[0], sums[1] / sums[0], sums[2] / sums[0]]
    }
}
