//! The seam at a hinge between two parts of a sheet.
//!
//! Parts are separated along panel edges, which are slits except at the hinges. At a hinge the seam leaves the edges and
//! crosses the corner of one of the two panels, so that the ligament stays whole on the other panel's part:
//!
//! ```text
//!   ----C--E----------   secondary cut         C: corner of the hinge, o: tip of the main cut, with its hole
//!         /                                    E: ends of the seam, on the two edges of panel B
//!       o/                                     The triangle C E E stays with panel A, and is joined to the
//!   A   E    B                                 rest of panel B by adhesive tape over the seam E E.
//!       |  main cut
//! ```

use crate::cut_file::fabrication_error::FabricationError;
use design::geometry::polygon::distance;
use design::sheet::cut_sheet::{Hinge, Sheet};
use design::sheet::topology::PanelCorner;

/// Distance of the tape from the tip, in ligament widths: the tip region of the smallest window.
const CLEAR_OF_TIP: f64 = 2.5;
/// Maximum length that a seam takes of a panel's edge, relative to the edge.
const OF_EDGE: f64 = 0.45;

/// The cut across the corner of a panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seam {
    /// The hinge whose ligament it keeps whole.
    pub hinge: usize,
    /// The panel that it crosses.
    pub panel: usize,
    /// The corner of the panel at the hinge, counter-clockwise from the south-west.
    pub(super) corner: usize,
    /// Its ends on the edges of the panel after and before the corner (mm).
    pub ends: [[f64; 2]; 2],
}

/// A seam across a corner of a panel.
struct Across {
    /// Its ends (mm).
    ends: [[f64; 2]; 2],
    /// The length that it needs of both edges, and the length that they have for it (mm).
    needed: f64,
    room: f64,
    /// Cosine of half the angle between the edges: the width of the tape over the length that it needs.
    cos: f64,
}

impl Seam {
    /// The seam at a hinge, in the panel that has more room for it. Tape reaches `lap` (mm) to either side of a seam.
    pub(super) fn new(sheet: &Sheet, number: usize, lap: f64) -> Result<Self, FabricationError> {
        let hinge = &sheet.hinges[number];
        let [a, b] = [hinge.site.a, hinge.site.b].map(|at| Self::across(sheet, hinge, at, lap));
        let fill = |seam: &Across| seam.needed / seam.room;
        let (at, seam) = if fill(&a) < fill(&b) {
            (hinge.site.a, a)
        } else {
            (hinge.site.b, b)
        };
        let (hinge, (panel, corner)) = (number, at);
        if seam.needed > seam.room {
            return Err(FabricationError::NoRoomForSeam {
                hinge,
                panel,
                lap,
                widest: lap - (seam.needed - seam.room) * seam.cos,
            });
        }
        let ends = seam.ends;
        Ok(Self {
            hinge,
            panel,
            corner,
            ends,
        })
    }

    fn across(sheet: &Sheet, hinge: &Hinge, (panel, corner): PanelCorner, lap: f64) -> Across {
        let corners = &sheet.panels[panel].corners;
        let from = corners[corner];
        let neighbours = [corners[(corner + 1) % 4], corners[(corner + 3) % 4]];
        let lengths = neighbours.map(|to| distance(from, to));
        let [u, v] = std::array::from_fn(|side| {
            let along = |axis: usize| (neighbours[side][axis] - from[axis]) / lengths[side];
            [along(0), along(1)]
        });
        // Half the length of u + v is the cosine of half the angle between the edges.
        let cos = 0.5 * f64::hypot(u[0] + v[0], u[1] + v[1]);
        let needed = distance(from, hinge.tip) + (CLEAR_OF_TIP * hinge.w_lig + lap) / cos;
        let ends = [u, v].map(|[x, y]| [from[0] + needed * x, from[1] + needed * y]);
        Across {
            ends,
            needed,
            room: OF_EDGE * lengths[0].min(lengths[1]),
            cos,
        }
    }
}
