//! A whole sheet with its supports and loads, and everything that determines the result of its
//! solve.
//!
//! The path leads from the flat sheet, lambda = 0, to full load or the full stroke, lambda = 1. How
//! the weight comes on depends on what keeps the panels in their plane ([`SheetProblem::history`]).

use crate::{StepControl, ToolVersions};
use hinge::SheetMaterial;
use mesher::{Panels, SheetShape, Tier};
use serde::{Deserialize, Serialize};
use support::interpolation::piece;
use support::{Fault, Point, ensure, refuse};

/// Version of the geometry, the input deck and the evaluation of sheets. It is increased when a
/// change of the code changes results; solves of an older version are then stale.
const RECIPE_VERSION: u32 = 3;

/// What keeps the panels in their plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OutOfPlaneRestraint {
    /// The panels cannot leave it; the ligaments can.
    HeldFlat,
    /// A table, from below, without friction.
    Table,
    /// Nothing but their own stiffness.
    Nothing,
}

/// Where a panel is held.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Place {
    /// All of it outside of its windows.
    Panel,
    /// A point, through the thickness (mm).
    Point(Point),
    /// A straight line between two points of an edge (mm).
    Line([Point; 2]),
}

/// A panel that is held.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeldPanel {
    /// Index of the panel.
    pub panel: usize,
    /// The part of it that is held; also out of the plane.
    pub place: Place,
    /// The prescribed ones of (u_x, u_y) at full load (mm).
    pub motion: [Option<f64>; 2],
}

/// A panel that is pulled.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pulled {
    /// Index of the panel.
    pub panel: usize,
    /// The pulled point of its middle surface (mm).
    pub at: Point,
    /// Force at full load (N).
    pub force: Point,
}

/// A sheet problem, without what solves it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SheetProblem {
    /// The sheet.
    pub shape: SheetShape,
    /// Mesh tier of its windows.
    pub tier: Tier,
    /// The sheet material.
    pub material: SheetMaterial,
    /// What keeps the panels in their plane.
    #[serde(rename = "keeping")]
    pub restraint: OutOfPlaneRestraint,
    /// Supports.
    pub held: Vec<HeldPanel>,
    /// Loads.
    pub pulled: Vec<Pulled>,
    /// The stroke at the end of the path (mm) if it is prescribed: the work of the full loads over
    /// the sum of their magnitudes. Without it the loads grow.
    pub stroke: Option<f64>,
    /// Unit vector along gravity; `None` without weight.
    pub down: Option<[f64; 3]>,
    /// The increments of the solve.
    pub step: StepControl,
    /// Whether the flanks of cuts touch; otherwise they pass through each other.
    pub contact: bool,
    /// Whether inertia carries the sheet over a snap that has no static path; the path then takes
    /// ten seconds.
    pub dynamic: bool,
}

/// All inputs of the result of a sheet solve. Its id is a hash of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SheetSolve {
    /// The sheet problem.
    pub problem: SheetProblem,
    /// Versions of the external programs.
    pub tools: ToolVersions,
    /// Version of the geometry, the input deck and the evaluation.
    pub recipe_version: u32,
}

/// Duration of a dynamic path (s): long against the periods of a sheet of paper size, so that it
/// moves nearly at rest.
pub(crate) const SECONDS: f64 = 10.0;

/// When the weight comes on, and the loads after it: (lambda, fraction) with straight lines
/// between.
#[derive(Debug)]
pub struct History {
    /// Fraction of the weight.
    pub weight: Vec<Point>,
    /// Fraction of the loads, the stroke and the motions of supports.
    pub loads: Vec<Point>,
}

/// Least area that points off one line span (mm^2).
const LEAST_SPREAD: f64 = 1.0;
/// The part of the path in which the weight comes on before the loads.
const WEIGHT_FIRST: f64 = 0.1;
/// The part of a dynamic path in which a table takes up the weight.
const TABLE_FIRST: f64 = 0.02;

impl SheetProblem {
    /// When weight and loads come on. Before the loads on a sheet whose panels are held flat, as in
    /// the model. On a table at once, because only the weight holds the panels down. On a sheet
    /// that nothing keeps in its plane together with the loads: alone it would buckle the sheet
    /// between its grips.
    pub fn history(&self) -> History {
        let even = || vec![[0.0, 0.0], [1.0, 1.0]];
        let first = |part: f64| History {
            weight: vec![[0.0, 0.0], [part, 1.0], [1.0, 1.0]],
            loads: vec![[0.0, 0.0], [part, 0.0], [1.0, 1.0]],
        };
        match (self.restraint, self.down) {
            (OutOfPlaneRestraint::Table, _) if self.dynamic => first(TABLE_FIRST),
            (OutOfPlaneRestraint::Table, _) => {
                History { weight: vec![[0.0, 1.0], [1.0, 1.0]], loads: even() }
            }
            (OutOfPlaneRestraint::HeldFlat, Some(_)) => first(WEIGHT_FIRST),
            (OutOfPlaneRestraint::HeldFlat, None) | (OutOfPlaneRestraint::Nothing, _) => {
                History { weight: even(), loads: even() }
            }
        }
    }

    /// An error if the problem has no solution.
    pub fn validate(&self) -> Result<(), Fault> {
        let moves = |held: &HeldPanel| held.motion.into_iter().flatten().any(|shift| shift != 0.0);
        ensure!(
            self.total_load() != 0.0 || self.held.iter().any(moves),
            "nothing pulls the sheet: it needs a load, or a support that moves"
        );
        ensure!(!self.held.is_empty(), "no panel is held: the sheet is free to move");
        ensure!(
            self.restraint != OutOfPlaneRestraint::Nothing || self.is_held_upright(),
            "nothing keeps the sheet in its plane, and no panel is clamped: it would fall out of it; clamp a panel, pin three \
     that are not on one line, or hold it flat"
        );
        if self.shape.model == Panels::Rigid
            && (self.contact || self.restraint == OutOfPlaneRestraint::Table)
        {
            refuse!(
                "rigid panels have no flanks that touch and do not rest on a table: use --sheet meshed"
            );
        }
        Ok(())
    }

    /// Whether its supports alone keep the sheet from turning out of its plane: a clamp, or points
    /// that are not on one line.
    fn is_held_upright(&self) -> bool {
        let point = |held: &HeldPanel| match held.place {
            Place::Point(at) => Some(at),
            Place::Panel | Place::Line(_) => None,
        };
        let points: Option<Vec<Point>> = self.held.iter().map(point).collect();
        points.is_none_or(|points| {
            let [x, y] = points[0];
            let arms = points.iter().map(|point| [point[0] - x, point[1] - y]);
            arms.clone().any(|p| arms.clone().any(|q| p[0] * q[1] - p[1] * q[0] > LEAST_SPREAD))
        })
    }

    /// The sum of the magnitudes of the loads (N).
    pub fn total_load(&self) -> f64 {
        let magnitudes = self.pulled.iter().map(|pulled| {
            let [x, y] = pulled.force;
            x.hypot(y)
        });
        magnitudes.sum()
    }

    /// The increments of a sheet: short at first where it may leave its plane.
    pub fn usual_step(restraint: OutOfPlaneRestraint, contact: bool) -> StepControl {
        StepControl {
            initial: match restraint {
                OutOfPlaneRestraint::HeldFlat => 0.004,
                OutOfPlaneRestraint::Table | OutOfPlaneRestraint::Nothing => 0.001,
            },
            // A panel that snaps on a table has no static path beyond: shorter increments do not
            // find one.
            least: match restraint {
                OutOfPlaneRestraint::Table => 1e-5,
                OutOfPlaneRestraint::HeldFlat | OutOfPlaneRestraint::Nothing => 1e-6,
            },
            // Flanks that meet in a longer increment rarely converge.
            greatest: if contact { 0.015 } else { 0.04 },
            max_increments: 600,
            ..StepControl::default()
        }
    }

    /// The increments of a dynamic path: a snap takes milliseconds of its seconds.
    pub(crate) fn dynamic_step() -> StepControl {
        StepControl {
            initial: 1e-4,
            least: 1e-9,
            greatest: 0.02,
            max_increments: 3000,
            ..StepControl::default()
        }
    }
}

impl History {
    /// The fraction of the loads at `lambda`.
    pub fn load_fraction(&self, lambda: f64) -> f64 {
        interpolated(&self.loads, lambda)
    }

    /// The fraction of the weight at `lambda`.
    pub(crate) fn weight_fraction(&self, lambda: f64) -> f64 {
        interpolated(&self.weight, lambda)
    }
}

/// The value at `x` of a table of (x, value), with straight lines between.
fn interpolated(table: &[Point], x: f64) -> f64 {
    let ([_, from], [_, to], fraction) = piece(table, |row| row[0], x);
    from + fraction * (to - from)
}

impl SheetSolve {
    /// The solve of a problem with programs of these versions.
    pub fn new(problem: SheetProblem, tools: &ToolVersions) -> Self {
        Self { problem, tools: tools.clone(), recipe_version: RECIPE_VERSION }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loads_follow_the_weight_where_the_model_has_it_first() {
        let history = History {
            weight: vec![[0.0, 0.0], [0.1, 1.0], [1.0, 1.0]],
            loads: vec![[0.0, 0.0], [0.1, 0.0], [1.0, 1.0]],
        };
        let at = |lambda| history.load_fraction(lambda);
        assert_eq!([at(0.0), at(0.05), at(0.1), at(1.0)], [0.0, 0.0, 0.0, 1.0]);
        assert!((at(0.55) - 0.5).abs() < 1e-15);
    }
}
