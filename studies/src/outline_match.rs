//! How a deployed outline matches its target: through the corners that belong to no hinge, the paper's point set, and
//! through all corners, for which the notches between the free ones are missing area.

use design::geometry::polygon::nearest_on_outline;
use design::geometry::symmetric_difference::intersection_over_union;
use design::objective::shape::OutlinePoints;
use design::sheet::cut_sheet::Sheet;

/// The match of one outline, first through its free corners, then through all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutlineMatch {
    pub free: Match,
    pub all: Match,
}

/// The match of a set of outline corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Match {
    /// Mean distance of the corners from the target's curve (mm).
    pub mean: f64,
    /// Root mean square distance of the corners from the target's curve (mm).
    pub rms: f64,
    /// Root mean square distance of the target's points from the nearest corner (mm).
    pub uncovered: f64,
    /// Intersection over union of the polygon through the corners and the target.
    pub shared: f64,
}

impl OutlineMatch {
    /// For the deployed corners of the panels of a sheet, in the position of the target.
    pub fn new(sheet: &Sheet, deployed: &[[[f64; 2]; 4]], target: &[[f64; 2]]) -> Self {
        let [free, all] = [OutlinePoints::Free, OutlinePoints::All].map(|points| {
            let corners = points.corners(sheet).into_iter();
            let outline: Vec<_> = corners.map(|(k, corner)| deployed[k][corner]).collect();
            Match::new(&outline, target)
        });
        Self { free, all }
    }
}

impl Match {
    fn new(outline: &[[f64; 2]], target: &[[f64; 2]]) -> Self {
        let from_curve: Vec<f64> = (outline.iter())
            .map(|corner| distance(*corner, nearest_on_outline(*corner, target)))
            .collect();
        let to_corner: Vec<f64> = (target.iter())
            .map(|t| {
                let distances = outline.iter().map(|corner| distance(*corner, *t));
                distances.fold(f64::INFINITY, f64::min)
            })
            .collect();
        Self {
            mean: from_curve.iter().sum::<f64>() / from_curve.len() as f64,
            rms: rms(&from_curve),
            uncovered: rms(&to_corner),
            shared: intersection_over_union(outline, target),
        }
    }
}

fn distance(p: [f64; 2], q: [f64; 2]) -> f64 {
    f64::hypot(p[0] - q[0], p[1] - q[1])
}

fn rms(distances: &[f64]) -> f64 {
    (distances.iter().map(|d| d * d).sum::<f64>() / distances.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_with_one_corner_off_its_target() {
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        let same = Match::new(&square, &square);
        assert_eq!((same.mean, same.rms, same.uncovered), (0.0, 0.0, 0.0));
        assert!((same.shared - 1.0).abs() < 1e-12);
        let cut = [[0.0, 0.0], [2.0, 0.0], [1.0, 1.0], [0.0, 2.0]];
        let off = Match::new(&cut, &square);
        assert!((off.mean - 0.25).abs() < 1e-12 && (off.rms - 0.5).abs() < 1e-12);
        assert!((off.uncovered - 0.5f64.sqrt()).abs() < 1e-12);
        assert!((off.shared - 0.5).abs() < 1e-3);
    }
}
