//! The gaps between cuts.
//!
//! Two cuts leave at least the width of a slit between them, and so do holes and outline. A slit then meets
//! the outline at most once and no other cut, so that the sheet stays in one piece.

use design::geometry::{
    polygon::{distance_between_segments, distance_to_outline},
    region::Ring,
};
use support::{Extremes, Fault, Point, ensure};

/// A cut with the width of the tool: the points nearer than `radius` to the segment `ends`, which
/// is a point for a hole.
pub(super) struct Cut {
    pub ends: [Point; 2],
    pub radius: f64,
    /// The hinges at its ends.
    pub hinges: Vec<usize>,
}

/// An error if cuts leave less than `least` (mm) between them, or a hole and the outline do.
pub(super) fn check(mut cuts: Vec<Cut>, outlines: &[Ring], least: f64) -> Result<(), Fault> {
    for hole in cuts.iter().filter(|cut| cut.ends[0] == cut.ends[1]) {
        let to_outlines = outlines.iter().map(|outline| distance_to_outline(hole.ends[0], outline));
        let gap = to_outlines.smallest() - hole.radius;
        ensure!(
            gap >= least,
            "the hole of hinge {} leaves {gap:.3} mm to the outline, less than a slit of {least} mm: move the cut \
             (objective.panel_shape) or reduce the fillet ratio",
            hole.hinges[0]
        );
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
            ensure!(
                gap >= least,
                "the cuts at the hinges {} and {} leave {gap:.3} mm between them, less than a slit of {least} mm: move them \
                 apart (objective.panel_shape) or narrow the ligaments",
                cut.hinges[0],
                other.hinges[0]
            );
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
        let met = of([[5.0, 8.0], [5.0, 1.0]]).unwrap_err().to_string();
        assert!(met.starts_with("the cuts at the hinges 0 and 1 leave -"), "{met}");
        let at_edge = of([[5.0, 8.9]; 2]).unwrap_err().to_string();
        assert!(at_edge.starts_with("the hole of hinge 1 leaves"), "{at_edge}");
    }
}
