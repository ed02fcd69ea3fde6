//! The shape term of the objective: the Chamfer distance of the deployed outline to the target. Its
//! points P are the panel corners on the outline that belong to no hinge.

use crate::{
    geometry::{
        chamfer::chamfer,
        plane::{I, complex, dot, point},
    },
    objective::{
        centre,
        term::{Deployed, Term, TermGradient},
    },
    pattern::fit_variables::FitVariables,
};
use faer::c64;
use support::Point;

/// The distance of the deployed outline to a target.
#[derive(Clone, Debug, PartialEq)]
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
        let placed = self.placed(at.outline, at.fit);
        let (chamfer, by_placed) = self.distance(&placed);
        self.pullback(at, &placed, &by_placed, weight, gradient);
        chamfer
    }
}

impl ShapeDistance {
    /// The distance to the points `target` (mm) with the coverage weight 1/2 of the paper.
    pub fn new(target: Vec<Point>) -> Self {
        Self { target, coverage_weight: 0.5, centred: false }
    }

    /// The points P in the position in which they are compared with the target (mm): centred, and
    /// in the size and the rotation of a target that is fitted to them.
    pub fn placed(&self, outline: &[Point], fit: Option<FitVariables>) -> Vec<Point> {
        let [x, y] = match self.centred {
            true => centre::of(outline),
            false => [0.0; 2],
        };
        let turn = turn(fit);
        let place = |[px, py]: &Point| point(turn * c64::new(px - x, py - y));
        outline.iter().map(place).collect()
    }

    /// Adds `weight` times the gradient in the points P, and in the fit, from that in the placed
    /// points.
    pub(crate) fn pullback(
        &self,
        at: &Deployed,
        placed: &[Point],
        by_placed: &[Point],
        weight: f64,
        gradient: &mut TermGradient,
    ) {
        let back = turn(at.fit).conj();
        let turned: Vec<_> =
            (by_placed.iter()).map(|slope| point(back * complex(*slope))).collect();
        let by_outline = match self.centred {
            true => centre::pullback(at.outline, &turned),
            false => turned,
        };
        gradient.add_by_outline(weight, &by_outline);
        for (p, slope) in std::iter::zip(placed, by_placed) {
            let (p, slope) = (complex(*p), complex(*slope));
            gradient.by_fit[0] -= weight * dot(slope, p);
            gradient.by_fit[1] -= weight * dot(slope, I * p);
        }
    }

    /// The Chamfer distance of placed points to the target (mm^2), and its gradient in them.
    pub fn distance(&self, placed: &[Point]) -> (f64, Vec<Point>) {
        chamfer(placed, &self.target, self.coverage_weight)
    }
}

/// Scale and rotation of the sheet to the target as in the scene: a target of twice the size has a
/// sheet of half the size.
pub fn turn(fit: Option<FitVariables>) -> c64 {
    fit.map_or(c64::ONE, |fit| c64::cis(-fit.rotation) * (-fit.ln_size).exp())
}
