//! A cut sheet of panels and the windows that join them.
//!
//! A panel is bounded by finished edges, half a kerf inside of the lines of its cuts, and ends at
//! the arcs of its windows.

use crate::{Side, Structured, Window};
use hinge::HingeDesign;
use serde::{Deserialize, Serialize};
use support::Point;

/// Ligament width over thickness up to which a ligament of a sheet bends in the plane first, and
/// tips over later.
const IN_PLANE: f64 = 2.0;

/// Pieces of the arc of a window in the outline of a panel.
const ARC_PIECES: usize = 12;

/// How panels are modelled outside of the windows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Panels {
    /// Rigid bodies that hold the arcs of their windows: only windows are meshed.
    #[default]
    Rigid,
    /// Meshed, as the windows are.
    Meshed,
}

/// All that determines the mesh of a sheet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SheetShape {
    /// Sheet thickness (mm).
    pub thickness: f64,
    /// How panels are modelled.
    pub model: Panels,
    /// The panels.
    pub panels: Vec<PanelPolygon>,
    /// The windows of the hinges.
    pub windows: Vec<PlacedWindow>,
    /// Plane mesh of the windows.
    pub plane: Structured,
    /// Layers of elements through the meshed thickness; even if that is all of it, so that the
    /// middle of the sheet has nodes.
    pub layers: usize,
    /// Whether only the upper half of the thickness is meshed, of a sheet that is symmetric about
    /// its middle.
    pub half: bool,
    /// Size of the elements of the panels (mm).
    pub element_size: f64,
}

/// A panel in the flat sheet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PanelPolygon {
    /// Where its finished edges meet, counter-clockwise (mm).
    pub corners: Vec<Point>,
    /// Points at which the mesh has nodes (mm), inside of the panel or on its finished edges.
    pub marks: Vec<Point>,
}

/// A window in the flat sheet.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlacedWindow {
    /// The hinge design.
    pub design: HingeDesign,
    /// The hinge frame: its origin is the foot of the ligament on the finished edge of the
    /// secondary cut.
    pub frame: Frame,
    /// Panels A and B, each with the number of its corner.
    pub panels: [(usize, usize); 2],
    /// Height of the bump that initiates buckling, over the thickness; its sign is the side to
    /// which it points.
    pub bump: f64,
}

impl SheetShape {
    /// Whether a ligament of a width (mm) bends in the plane of a sheet of a thickness (mm).
    /// Ligaments of one to two thicknesses are of no law's regime: a bump as high as the sheet is
    /// thick would make them softer than they are (docs/results/plates).
    pub fn bends_in_plane(w_lig: f64, thickness: f64) -> bool {
        w_lig <= IN_PLANE * thickness
    }

    /// The meshed part of the thickness (mm).
    pub fn meshed_thickness(&self) -> f64 {
        if self.half { 0.5 * self.thickness } else { self.thickness }
    }

    /// The outline of a panel outside of its windows, counter-clockwise (mm).
    pub fn outline(&self, panel: usize) -> Vec<Point> {
        let at_corner = |(corner, point): (usize, &Point)| {
            let place = (panel, corner);
            let at = |window: &&PlacedWindow| window.panels.contains(&place);
            match self.windows.iter().find(at) {
                Some(window) if window.panels[0] == place => window.arc(Side::A),
                Some(window) => window.arc(Side::B),
                None => vec![*point],
            }
        };
        self.panels[panel].corners.iter().enumerate().flat_map(at_corner).collect()
    }
}

impl PanelPolygon {
    /// The ends of the edge that begins at a corner.
    pub(crate) fn edge(&self, corner: usize) -> [Point; 2] {
        [self.corners[corner], self.corners[(corner + 1) % self.corners.len()]]
    }

    /// The edge that ends at a corner.
    pub(crate) fn edge_before(&self, corner: usize) -> usize {
        (corner + self.corners.len() - 1) % self.corners.len()
    }

    /// Adds a point at which the mesh has a node, once (mm).
    pub fn mark(&mut self, point: Point) {
        if !self.marks.contains(&point) {
            self.marks.push(point);
        }
    }
}

impl PlacedWindow {
    /// Points of its arc on a panel, clockwise about its origin (mm).
    fn arc(&self, side: Side) -> Vec<Point> {
        let (window, radius) = (Window(&self.design), self.design.r_win);
        let points = window.panel_arc(side, radius, ARC_PIECES).into_iter().rev();
        points.map(|point| self.frame.point(point)).collect()
    }
}

/// An origin and the direction of the x axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Position of the origin (mm).
    pub origin: Point,
    /// Unit vector along the x axis.
    pub e_x: Point,
}

impl Default for Frame {
    /// The frame in which positions are given.
    fn default() -> Self {
        Self { origin: [0.0; 2], e_x: [1.0, 0.0] }
    }
}

impl Frame {
    /// The position of the point (x, y) of the frame (mm).
    pub fn point(&self, [x, y]: Point) -> Point {
        let ([o_x, o_y], [c, s]) = (self.origin, self.e_x);
        [o_x + c * x - s * y, o_y + s * x + c * y]
    }

    /// The coordinates in the frame of a point (mm).
    pub fn local(&self, point: Point) -> Point {
        let [c, s] = self.e_x;
        let [x, y] = [0, 1].map(|i| point[i] - self.origin[i]);
        [c * x + s * y, c * y - s * x]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn local_coordinates_are_those_of_the_point() {
        let frame = Frame { origin: [3.0, -2.0], e_x: [0.6, 0.8] };
        assert_eq!(frame.point([0.0, 0.0]), frame.origin);
        let [x, y] = frame.local(frame.point([1.5, -0.5]));
        assert!((x - 1.5).abs() + (y + 0.5).abs() < 1e-15);
        assert_eq!(Frame::default().point([0.25, -7.0]), [0.25, -7.0]);
    }
}
