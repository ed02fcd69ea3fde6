//! The gaps between cuts.
//!
//! Two cuts leave at least the width of a slit between them, and so do holes and outline. A slit then meets
//! the outline at most once and no other cut, so that the sheet stays in one piece.

use crate::cut_file::fabrication_error::FabricationError;
use design::geometry::polygon::{distance_between_segments, distance_to_outline};
use design::geometry::region::Contour;

/// A cut with the width of the tool: the points nearer than `radius` to the segment `ends`, which
/// is a point for a hole.
pub(super) struct Cut {
    pub ends: [[f64; 2]; 2],
    pub radius: f64,
    /// The hinges at its ends.
    pub hinges: Vec<usize>,
}

/// An error if cuts leave less than `least` (mm) between them, or a hole and the outline do.
pub(super) fn check(
    mut cuts: Vec<Cut>,
    outlines: &[Contour],
    least: f64,
) -> Result<(), FabricationError> {
    for hole in cuts.iter().filter(|cut| cut.ends[0] == cut.ends[1]) {
        let to_outlines = outlines.iter().map(|outline| distance_to_outline(hole.ends[0], outline));
        let gap = to_outlines.fold(f64::INFINITY, f64::min) - hole.radius;
        if gap < least {
            let hinge = hole.hinges[0];
            return Err(FabricationError::CutMeetsOutline { hinge, gap, least });
        }
    }
    // Cuts from left to right: only those that begin before another ends can meet it.
    let side = |cut: &Cut, of: fn(f64, f64) -> f64| of(cut.ends[0][0], cut.ends[1][0]);
    cuts.sort_by(|a, b| side(a, f64::min).total_cmp(&side(b, f64::min)));
    for (i, cut) in cuts.iter().enumerate() {
        let reach = side(cut, f64::max) + cut.radius + least;
        let near = cuts[i + 1..]
            .iter()
            .take_while(|other| side(other, f64::min) < reach + other.radius + cut.radius);
        for other in near {
            if cut.hinges.iter().any(|hinge| other.hinges.contains(hinge)) {
                continue;
            }
            let apart = distance_between_segments(cut.ends, other.ends);
            let gap = apart - cut.radius - other.radius;
            if gap < least {
                let hinges = [cut.hinges[0], other.hinges[0]];
                return Err(FabricationError::CutsMeet { hinges, gap, least });
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slit_through_another_and_a_hole_at_the_outline_are_refused() {
        let outline = vec![vec![[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]]];
        let of = |ends| {
            let cut = |ends: [[f64; 2]; 2], hinge| Cut { ends, radius: 0.1, hinges: vec![hinge] };
            check(vec![cut([[1.0, 5.0], [8.0, 5.0]], 0), cut(ends, 1)], &outline, 0.2)
        };
        assert!(of([[1.0, 6.0], [8.0, 5.5]]).is_ok());
        let met = of([[5.0, 8.0], [5.0, 1.0]]);
        let meet = matches!(met, Err(FabricationError::CutsMeet { gap, .. }) if gap < 0.0);
        assert!(meet, "{met:?}");
        let at_edge = of([[5.0, 8.9]; 2]);
        let meet = matches!(at_edge, Err(FabricationError::CutMeetsOutline { hinge: 1, .. }));
        assert!(meet, "{at_edge:?}");
    }
}
