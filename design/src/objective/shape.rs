//! The shape term of the objective: the Chamfer distance of the deployed outline to the target. Its
//! points P are the panel corners on the outline that belong to no hinge.

use crate::{
    geometry::chamfer::chamfer,
    objective::{
        centre,
        term::{Deployed, Term, TermGradient},
    },
};
use support::Point;

/// The distance of the deployed outline to a target.
#[derive(Clone, Debug)]
pub struct ShapeDistance {
    /// T (mm); not empty.
    pub target: Vec<Point>,
    /// w_cov of the distance (dimensionless).
    pub coverage_weight: f64,
    /// Whether the centroid of the area inside P is translated to the origin, where the centroid of
    /// the target should be: not where supports hold the sheet.
    pub centred: bool,
}

impl Term for ShapeDistance {
    fn name(&self) -> &'static str {
        "chamfer"
    }

    fn unit(&self) -> Option<&'static str> {
        Some("mm^2")
    }

    fn evaluate(&self, at: &Deployed, weight: f64, gradient: &mut TermGradient) -> f64 {
        let placed = self.placed(at.outline);
        let (chamfer, by_placed) = self.distance(&placed);
        self.pullback(at, &by_placed, weight, gradient);
        chamfer
    }
}

impl ShapeDistance {
    /// The distance to the points `target` (mm) with the coverage weight 1/2 of the paper.
    pub fn new(target: Vec<Point>) -> Self {
        Self { target, coverage_weight: 0.5, centred: false }
    }

    /// The points P in the position in which they are compared with the target (mm).
    pub fn placed(&self, outline: &[Point]) -> Vec<Point> {
        let [x, y] = match self.centred {
            true => centre::of(outline),
            false => [0.0; 2],
        };
        outline.iter().map(|[px, py]| [px - x, py - y]).collect()
    }

    /// Adds `weight` times the gradient in the points P, from the gradient in the placed points.
    pub(crate) fn pullback(
        &self,
        at: &Deployed,
        by_placed: &[Point],
        weight: f64,
        gradient: &mut TermGradient,
    ) {
        match self.centred {
            true => gradient.add_by_outline(weight, &centre::pullback(at.outline, by_placed)),
            false => gradient.add_by_outline(weight, by_placed),
        }
    }

    /// The Chamfer distance of placed points to the target (mm^2), and its gradient in them.
    pub fn distance(&self, placed: &[Point]) -> (f64, Vec<Point>) {
        chamfer(placed, &self.target, self.coverage_weight)
    }
}
