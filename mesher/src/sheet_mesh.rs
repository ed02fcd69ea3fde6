//! A sheet as solid elements: its plane mesh extruded to layers, with a bump at every hinge.

use crate::{
    Extrusion, Imperfection, Levels, MAX_AREA_ERROR, PlacedWindow, PlaneMesh, SheetShape, Side,
    Window, check_elements, cross, dot, minus, unit, wrong_area,
};
use support::fault::Fault;

/// Largest distance of a node from the arc of its window, over r_win.
const ON_RIM: f64 = 1e-6;
/// Largest distance of a node on a straight edge from it (mm).
const ON_EDGE: f64 = 1e-6;
/// Distance from the foot of a ligament, over w_lig, up to which a flank belongs to the ligament
/// and its hole.
const AT_LIGAMENT: f64 = 2.0;

/// What a face or an element of a sheet belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The part of a panel outside of all windows.
    Panel(usize),
    /// A window.
    Window(usize),
}

/// A sheet of solid elements; indices count from 0.
#[derive(Clone, Debug)]
pub struct SheetMesh {
    /// The plane mesh that was extruded.
    pub plane: PlaneMesh,
    /// The part of each face, and of each element of each layer above it.
    pub parts: Vec<Part>,
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
    levels: Levels,
}

impl SheetMesh {
    pub(crate) fn new(shape: &SheetShape, plane: PlaneMesh) -> Result<Self, Fault> {
        let panels = shape.panels.len();
        let parts: Vec<Part> = (plane.surfaces.iter())
            .map(|tag| match (*tag as usize).saturating_sub(1) {
                panel if panel < panels => Part::Panel(panel),
                window => Part::Window(window - panels),
            })
            .collect();
        let mut height = vec![0.0; plane.nodes.len()];
        for (face, part) in std::iter::zip(&plane.faces, &parts) {
            if let Part::Window(window) = part {
                let window = &shape.windows[*window];
                for node in face {
                    height[*node] = window.height(shape.thickness, plane.nodes[*node]);
                }
            }
        }
        let solid = Extrusion::new(&plane, shape.thickness, shape.layers, |node| height[node]);
        check_elements(&plane, &solid.gauss_volumes)?;
        let volume: f64 = solid.gauss_volumes.iter().flatten().sum();
        let (area, exact) = (volume / shape.thickness, shape.area());
        if (area - exact).abs() > MAX_AREA_ERROR * exact {
            return Err(wrong_area(area, exact));
        }
        Ok(Self {
            middle: solid.levels.level(shape.layers),
            bottom: solid.levels.level(0),
            nodes: solid.nodes,
            elements: solid.elements,
            gauss_volumes: solid.gauss_volumes,
            levels: solid.levels,
            plane,
            parts,
        })
    }

    /// The part of an element.
    pub fn part(&self, element: usize) -> Part {
        self.parts[element % self.parts.len()]
    }

    /// The plane nodes of a part, in increasing order.
    pub fn plane_nodes(&self, part: Part) -> Vec<usize> {
        let faces = std::iter::zip(&self.plane.faces, &self.parts);
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

    /// The plane nodes on the arc of a window on one of its panels.
    pub fn rim(&self, shape: &SheetShape, window: usize, side: Side) -> Vec<usize> {
        let placed = &shape.windows[window];
        let (design, frame) = (&placed.design, &placed.frame);
        let (of_window, tip) = (Window(design), design.tip());
        let on_rim = |node: &usize| {
            let local = frame.local(self.plane.nodes[*node]);
            let [x, y] = local;
            let across = dot(minus(local, tip), of_window.normal());
            across * side.sign() > 0.0 && (x.hypot(y) / design.r_win - 1.0).abs() < ON_RIM
        };
        let mut nodes = self.plane_nodes(Part::Window(window));
        nodes.retain(on_rim);
        nodes
    }

    /// The side faces of elements that are the flank of a window's main cut on one of its panels,
    /// without those at ligaments and holes: (element, edge of its lower face). None on a panel
    /// that is not a part of the sheet.
    pub fn flank(&self, shape: &SheetShape, window: usize, side: Side) -> Vec<(usize, usize)> {
        let Some([from, to]) = shape.flank(window, side) else {
            return Vec::new();
        };
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
    pub fn nearest(&self, part: Part, point: [f64; 2]) -> Option<usize> {
        let distance = |node: &usize| {
            let [x, y] = minus(self.plane.nodes[*node], point);
            x.hypot(y)
        };
        let faces = std::iter::zip(&self.plane.faces, &self.parts);
        let corners = faces
            .filter(|(_, of)| **of == part)
            .flat_map(|(face, _)| face[..face.len() / 2].iter().copied());
        corners.min_by(|one, other| distance(one).total_cmp(&distance(other)))
    }
}

impl PlacedWindow {
    /// Height (mm) of the bump at a point of the window.
    fn height(&self, thickness: f64, point: [f64; 2]) -> f64 {
        let [x, y] = self.frame.local(point);
        let bump = Imperfection { amplitude: self.bump, widths: Imperfection::WIDTHS };
        bump.height(&self.design, thickness, x, y)
    }
}

impl SheetShape {
    /// The finished edge of a panel along the main cut of a window; `None` if the panel is not a
    /// part of the sheet.
    fn flank(&self, window: usize, side: Side) -> Option<[[f64; 2]; 2]> {
        let [a, b] = self.windows[window].panels;
        // Edges are counted by the corner at which they begin, counter-clockwise: the flank ends at
        // the corner of A.
        let (panel, edge) = match side {
            Side::A => a.map(|(panel, corner)| (panel, self.panels[panel].edge_before(corner))),
            Side::B => b,
        }?;
        Some(self.panels[panel].edge(edge))
    }

    /// Area of the sheet (mm^2): windows, and panels without the sectors of their windows.
    fn area(&self) -> f64 {
        let windows = self.windows.iter().map(|placed| {
            let (window, radius) = (Window(&placed.design), placed.design.r_win);
            // What the finished panels have in the half-disc is not theirs: the two sectors from
            // the crossing of their edges, at the corner of a panel, to the arcs.
            let sector = |(side, place): (Side, Option<(usize, usize)>)| {
                let (panel, corner) = place?;
                let apex = placed.frame.local(self.panels[panel].corners[corner]);
                let kerf = window.kerf_at_radius(side, radius);
                let free = [radius * side.sign(), 0.0];
                let angle = window.arc_angle(side);
                let triangle = 0.5 * cross(minus(kerf, apex), minus(free, apex)).abs();
                let segment = 0.5 * radius * radius * (angle - angle.sin());
                Some(triangle + segment)
            };
            let sectors = std::iter::zip(Side::BOTH, placed.panels).filter_map(sector);
            window.area() - sectors.sum::<f64>()
        });
        let panels = self.panels.iter().map(|panel| {
            let edges = (0..panel.corners.len()).map(|corner| panel.edge(corner));
            0.5 * edges.map(|[from, to]| cross(from, to)).sum::<f64>()
        });
        windows.sum::<f64>() + panels.sum::<f64>()
    }
}
