//! The shape term of the objective: the Chamfer distance of the deployed outline to the target. Its points P are the panel corners
//! on the outline that belong to no hinge.

use crate::geometry::chamfer::chamfer;
use crate::objective::centre;
use crate::objective::term::{Deployed, Term, TermGradient};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The state of the sheet that its target is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TargetState {
    /// At full load.
    #[default]
    Loaded,
    /// After the loads were taken off: the shape that stays.
    Released,
}

/// The distance of the deployed outline to a target.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// T (mm); not empty.
    pub target: Vec<[f64; 2]>,
    /// w_cov of the distance (dimensionless).
    pub coverage_weight: f64,
    /// Whether the centroid of the area inside P is translated to the origin, where that of the target should be: not where
    /// supports hold the sheet.
    pub centred: bool,
}

impl Term for Shape {
    fn name(&self) -> &'static str {
        "chamfer"
    }

    fn unit(&self) -> Option<&'static str> {
        Some("mm^2")
    }

    fn evaluate(&self, at: &Deployed, weight: f64, gradient: &mut TermGradient) -> f64 {
        let (chamfer, by_outline) = self.distance(at.outline);
        gradient.add_by_outline(weight, &by_outline);
        chamfer
    }
}

impl Shape {
    /// With the paper's coverage weight 1/2, to the points `target` (mm).
    pub fn new(target: Vec<[f64; 2]>) -> Self {
        Self {
            target,
            coverage_weight: 0.5,
            centred: false,
        }
    }

    /// The points P in the position in which they are compared with the target (mm).
    pub fn placed(&self, outline: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let [x, y] = match self.centred {
            true => centre::of(outline),
            false => [0.0; 2],
        };
        outline.iter().map(|[px, py]| [px - x, py - y]).collect()
    }

    /// The gradient in P from that in its placed points.
    pub(crate) fn pullback(&self, outline: &[[f64; 2]], placed: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
        match self.centred {
            true => centre::pullback(outline, &placed),
            false => placed,
        }
    }

    /// The Chamfer distance of the points P to the target (mm^2), and its gradient in P.
    pub fn distance(&self, outline: &[[f64; 2]]) -> (f64, Vec<[f64; 2]>) {
        let (distance, by_placed) =
            chamfer(&self.placed(outline), &self.target, self.coverage_weight);
        (distance, self.pullback(outline, by_placed))
    }
}
