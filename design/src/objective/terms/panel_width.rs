//! Barrier that keeps panels as wide as a cutter needs: the mean over panels of the sum over their
//! corners and the two edges that do not end at the corner of
//!
//! ```text
//! b(x) = (1 - x)^3 / x^2  for 0 < x < 1,    0 for x >= 1,    infinite for x <= 0,    x = (d -
//! d_min)/d_min
//! ```
//!
//! d is the distance of the corner from the line of the edge. The shortest edge of a panel is not
//! shorter than its smallest d. b is C^2; a search that begins with wider panels never evaluates a
//! design with a thinner one, because steps to an infinite loss are halved.

use crate::{
    geometry::plane::{I, complex, cross},
    objective::term::{Deployed, Term, TermGradient, over_panels},
};
use faer::c64;
use support::{Extremes, Point};

/// Weight of the barrier relative to d_min^2, and to the area of a square of this side.
const WEIGHT: f64 = 0.01;

/// The barrier at the minimum panel width.
#[derive(Clone, Copy, Debug)]
pub struct PanelWidth {
    /// d_min (mm), positive.
    pub minimum: f64,
}

impl Term for PanelWidth {
    fn name(&self) -> &'static str {
        "panel_width"
    }

    fn unit(&self) -> Option<&'static str> {
        Some("mm^2")
    }

    fn evaluate(&self, at: &Deployed, weight: f64, gradient: &mut TermGradient) -> f64 {
        let share = WEIGHT * self.minimum.powi(2) / at.sheet.panels.len() as f64;
        over_panels(at, weight, 1.0, gradient, |corners, value, gradient| {
            for (edge, corner) in PAIRS {
                let (distance, along, arm) = distance(corners, (edge, corner));
                let (barrier, slope) = barrier(distance / self.minimum - 1.0);
                *value += share * barrier;
                let pull = share * slope / (self.minimum * along.norm());
                let by_arm = I * along * pull;
                let by_along = -(I * arm + along * (distance / along.norm())) * pull;
                gradient[corner] += by_arm;
                gradient[(edge + 1) % 4] += by_along;
                gradient[edge] += -by_arm - by_along;
            }
        })
    }
}

/// The minimum distance of a corner from the line of an edge that does not end at it, over all
/// panels (mm).
pub fn thinnest_panel(panels: &[[Point; 4]]) -> f64 {
    let widths = panels.iter().flat_map(|panel| PAIRS.map(|pair| distance(panel, pair).0));
    widths.smallest()
}

/// The distance of a corner from the line of an edge, the edge, and the vector from its start to
/// the corner.
fn distance(panel: &[Point; 4], (edge, corner): (usize, usize)) -> (f64, c64, c64) {
    let [start, end, at] = [edge, (edge + 1) % 4, corner].map(|j| complex(panel[j]));
    let (along, arm) = (end - start, at - start);
    (cross(along, arm) / along.norm(), along, arm)
}

/// Edges, by the corner at which they start, and the corners that they do not contain.
const PAIRS: [(usize, usize); 8] = [(0, 2), (0, 3), (1, 3), (1, 0), (2, 0), (2, 1), (3, 1), (3, 2)];

/// b and db/dx.
fn barrier(x: f64) -> (f64, f64) {
    match x {
        x if x <= 0.0 || x.is_nan() => (f64::INFINITY, 0.0),
        x if x >= 1.0 => (0.0, 0.0),
        x => {
            let ratio = (1.0 - x) / x;
            let barrier = ratio * ratio * (1.0 - x);
            (barrier, -ratio * ratio * (3.0 + 2.0 * ratio))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objective::term::on_panels;
    use testkit::derivatives::assert_gradient;

    fn rectangle(length: f64, width: f64) -> [[f64; 2]; 4] {
        [[0.0, 0.0], [length, 0.0], [length, width], [0.0, width]]
    }

    #[test]
    fn a_panel_of_twice_the_width_is_free_and_one_of_the_width_is_excluded() {
        let value = |width| on_panels(&PanelWidth { minimum: 10.0 }, &[rectangle(50.0, width)]).0;
        assert_eq!(value(20.0), 0.0);
        assert_eq!(value(10.0), f64::INFINITY);
        // Two edges with two corners each, at x = 1/2.
        let expected = WEIGHT * 100.0 * 4.0 * 0.5;
        assert!((value(15.0) - expected).abs() < 1e-12);
    }

    #[test]
    fn the_thinnest_place_of_a_wedge_is_at_its_thin_end() {
        let wedge = [[0.0, 0.0], [50.0, 0.0], [50.0, 20.0], [0.0, 5.0]];
        let tilt = f64::hypot(50.0, 15.0);
        let width = thinnest_panel(&[rectangle(50.0, 20.0), wedge]);
        assert!((width - 5.0 * 50.0 / tilt).abs() < 1e-12, "{width}");
    }

    #[test]
    fn gradients_agree_with_differences() {
        let corners = [0.0, 0.1, 20.0, -0.2, 17.0, 8.1, 0.2, 6.9];
        let at = |x: &[f64]| std::array::from_fn(|j| [x[2 * j], x[2 * j + 1]]);
        let all =
            |x: &[f64]| on_panels(&PanelWidth { minimum: 5.0 }, &[at(x), rectangle(8.0, 8.0)]);
        let (value, gradient) = all(&corners);
        assert!(value > 0.1, "{value}");
        let found = gradient[0].as_flattened();
        assert_gradient(|x| all(x).0, &corners, found, 1e-6, |_| 1e-6 * value);
    }
}
