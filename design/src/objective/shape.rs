//! The shape term of the objective: the Chamfer distance of the deployed outline to the target.

use crate::geometry::chamfer::{Chamfer, Precision};
use crate::objective::centre::Centre;
use crate::objective::term::{Deployed, Term, TermGradient};
use crate::sheet::cut_sheet::Sheet;
use crate::sheet::topology::PanelCorner;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The panel corners on the outline that form the point set P of (16).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum OutlinePoints {
    /// Corners that belong to no hinge.
    #[default]
    Free,
    /// All corners on the outline.
    All,
}

impl OutlinePoints {
    /// P, counter-clockwise from the south-west.
    pub fn corners(self, sheet: &Sheet) -> Vec<PanelCorner> {
        match self {
            Self::Free => sheet.free_outline_corners(),
            Self::All => sheet.outline_corners(),
        }
    }
}

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
    /// Coverage weight and smoothness of the distance.
    pub chamfer: Chamfer,
    /// The panel corners that form P.
    pub outline: OutlinePoints,
    /// The point of P that is translated to the origin, where that of the target should be; `None` where supports hold
    /// the sheet.
    pub centre: Option<Centre>,
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
    /// With the paper's hard minima and coverage weight 1/2, of the free corners on the outline, to the points `target`
    /// (mm).
    pub fn new(target: Vec<[f64; 2]>) -> Self {
        Self {
            target,
            chamfer: Chamfer {
                coverage_weight: 0.5,
                smoothing: 0.0,
                precision: Precision::Samples,
            },
            outline: OutlinePoints::Free,
            centre: None,
        }
    }

    /// The points P in the position in which they are compared with the target (mm).
    pub fn placed(&self, outline: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let origin = self.centre.map_or([0.0; 2], |centre| centre.of(outline));
        let moved = |point: &[f64; 2]| [point[0] - origin[0], point[1] - origin[1]];
        outline.iter().map(moved).collect()
    }

    /// The gradient in P from that in its placed points.
    pub(crate) fn pullback(&self, outline: &[[f64; 2]], placed: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
        match self.centre {
            Some(centre) => centre.pullback(outline, &placed),
            None => placed,
        }
    }

    /// The Chamfer distance of the points P to the target (mm^2), and its gradient in P.
    pub fn distance(&self, outline: &[[f64; 2]]) -> (f64, Vec<[f64; 2]>) {
        let (chamfer, by_placed) = (self.chamfer).evaluate(&self.placed(outline), &self.target);
        (chamfer, self.pullback(outline, by_placed))
    }

    /// Vectors v in P whose sum of v v^T approximates the second derivative of the Chamfer distance (Gauss-Newton).
    pub(crate) fn curvature(&self, outline: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
        let factors = (self.chamfer).curvature_factors(&self.placed(outline), &self.target);
        let mut vectors = Vec::new();
        for (k, columns) in factors.into_iter().enumerate() {
            for column in columns.into_iter().filter(|column| *column != [0.0; 2]) {
                let mut placed = vec![[0.0; 2]; outline.len()];
                placed[k] = column;
                vectors.push(self.pullback(outline, placed));
            }
        }
        vectors
    }
}
