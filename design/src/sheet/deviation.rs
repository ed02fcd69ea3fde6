//! A sheet as it was cut, which differs from that of its drawing.
//!
//! A ligament is wider or narrower because the tip of its main cut is elsewhere. A wider kerf makes all ligaments narrower by half
//! of its error on either side, at their secondary cuts and at their holes, and leaves their tips:
//!
//! ```text
//! w_lig = w + dw - dk / 2,     rho_f w_lig = R(w) + dk / 2
//! ```
//!
//! with the width w and the radius R(w) of the hole in the drawing. A sheet of another thickness or of a stronger material has
//! the same cuts.

use crate::sheet::cut_sheet::Sheet;
use serde::Serialize;

/// The differences of a cut sheet from its drawing.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Deviation {
    /// Of the ligament width of every hinge (mm); empty for none.
    pub widths: Vec<f64>,
    /// Of the width that the cutter removes (mm).
    pub kerf: f64,
    /// Of the thickness (mm).
    pub thickness: f64,
    /// Of all stresses at equal strain, relative.
    pub stress: f64,
}

impl Sheet {
    /// The flat sheet as it was cut; `None` if a ligament has no width, or less than the radius of its hole.
    pub(crate) fn with_deviation(mut self, deviation: &Deviation) -> Option<Self> {
        let (options, narrower) = (self.options, 0.5 * deviation.kerf);
        for (h, hinge) in self.hinges.iter_mut().enumerate() {
            let wider = deviation.widths.get(h).copied().unwrap_or(0.0);
            let radius = options.process.hole_radius(hinge.w_lig) + narrower;
            *hinge = hinge.with_tip(hinge.set_back + wider, options.hinge_point);
            hinge.w_lig += wider - narrower;
            hinge.fillet_ratio = radius / hinge.w_lig;
            if !(hinge.w_lig > 0.0 && hinge.fillet_ratio < 1.0) {
                return None;
            }
        }
        Some(self)
    }
}
