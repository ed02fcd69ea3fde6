//! A cut sheet of panels and the windows that join them, or a part of one.
//!
//! A panel is bounded by finished edges, half a kerf inside of the lines of its cuts, and ends at
//! the arcs of its windows.

use crate::{Frame, Structured};
use hinge::HingeDesign;
use serde::{Deserialize, Serialize};

/// Ligament width over thickness up to which a ligament of a sheet bends in the plane first, and
/// tips over later.
const IN_PLANE: f64 = 2.0;

/// All that determines the mesh of a sheet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SheetShape {
    /// Sheet thickness (mm).
    pub thickness: f64,
    /// The panels.
    pub panels: Vec<PanelShape>,
    /// The windows of the hinges.
    pub windows: Vec<PlacedWindow>,
    /// Plane mesh of the windows.
    pub plane: Structured,
    /// Layers of elements through the thickness; even, so that the middle of the sheet has nodes.
    pub layers: usize,
    /// Size of the elements of the panels (mm).
    pub element_size: f64,
}

/// A panel in the flat sheet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PanelShape {
    /// Where its finished edges meet: SW, SE, NE, NW (mm).
    pub corners: [[f64; 2]; 4],
    /// Points at which the mesh has nodes (mm), inside of the panel or on its finished edges.
    pub marks: Vec<[f64; 2]>,
}

/// A window in the flat sheet.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlacedWindow {
    /// The hinge design.
    pub design: HingeDesign,
    /// The hinge frame: its origin is the foot of the ligament on the finished edge of the
    /// secondary cut.
    pub frame: Frame,
    /// Panels A and B, each with the number of its corner; `None` for a panel that is not a part of
    /// the sheet.
    pub panels: [Option<(usize, usize)>; 2],
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
}

impl PanelShape {
    /// Adds a point at which the mesh has a node, once (mm).
    pub fn mark(&mut self, point: [f64; 2]) {
        if !self.marks.contains(&point) {
            self.marks.push(point);
        }
    }
}
