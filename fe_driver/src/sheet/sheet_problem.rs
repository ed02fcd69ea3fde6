//! A whole sheet with its supports and loads, and everything that determines the result of its
//! solve.
//!
//! The path leads from the flat sheet, lambda = 0, to full load or the full stroke, lambda = 1. How
//! the weight comes on depends on what keeps the panels in their plane ([`SheetProblem::history`]).

use crate::{StepControl, ToolVersions};
use hinge::SheetMaterial;
use mesher::{SheetShape, Side, Tier};
use serde::{Deserialize, Serialize};
use support::fault::{Fault, fault};
use support::interpolation::piece;

/// Version of the geometry, the input deck and the evaluation of sheets. It is increased when a
/// change of the code changes results; solves of an older version are then stale.
const RECIPE_VERSION: u32 = 2;

/// What keeps the panels in their plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
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
    Point([f64; 2]),
    /// A straight line between two points of an edge (mm).
    Line([[f64; 2]; 2]),
}

/// A panel that is held.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Held {
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
    pub at: [f64; 2],
    /// Force at full load (N).
    pub force: [f64; 2],
}

/// The arc of a window on a panel that is not a part of the sheet, and the motion of that panel in
/// the plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DrivenRim {
    /// Index of the window.
    pub window: usize,
    /// The panel of the window that is missing.
    pub side: Side,
    /// The point of the panel that its motion refers to, in the flat sheet (mm).
    pub about: [f64; 2],
    /// (lambda, u_x, u_y, phi), with lambda increasing from 0 to 1 and straight lines between (mm,
    /// rad).
    pub path: Vec<[f64; 4]>,
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
    pub held: Vec<Held>,
    /// Loads.
    pub pulled: Vec<Pulled>,
    /// Where a part of a sheet is joined to the rest; none in a whole sheet.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rims: Vec<DrivenRim>,
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
#[derive(Clone, Debug, PartialEq)]
pub struct History {
    /// Fraction of the weight.
    pub weight: Vec<[f64; 2]>,
    /// Fraction of the loads, the stroke and the motions of supports.
    pub loads: Vec<[f64; 2]>,
}

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
        let moves = |held: &Held| held.motion.into_iter().flatten().any(|shift| shift != 0.0);
        if self.total_load() == 0.0 && self.rims.is_empty() && !self.held.iter().any(moves) {
            let remedy = "it needs a load, or a support that moves";
            return Err(fault("", "nothing pulls the sheet", remedy));
        }
        if self.held.is_empty() && self.rims.is_empty() {
            return Err(fault("", "no panel is held", "the sheet is free to move"));
        }
        let clamped = |held: &Held| !matches!(held.place, Place::Point(_));
        if self.restraint == OutOfPlaneRestraint::Nothing
            && self.rims.is_empty()
            && !self.held.iter().any(clamped)
        {
            let what = "nothing keeps the sheet in its plane, and no panel is clamped";
            return Err(fault("", what, "it would fall out of it; clamp a panel, or hold it flat"));
        }
        Ok(())
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
        interpolated(&self.loads, lambda)[1]
    }

    /// The lambda at which a fraction of the loads is on, or of the weight if that comes on before
    /// them.
    pub fn lambda_of(&self, weight: f64, loads: f64) -> f64 {
        let table = if weight < 1.0 { &self.weight } else { &self.loads };
        let inverse: Vec<[f64; 2]> =
            (table.iter()).map(|[lambda, fraction]| [*fraction, *lambda]).collect();
        // The last lambda at which no load is on.
        let from = inverse.iter().rposition(|[fraction, _]| *fraction == 0.0);
        let wanted = if weight < 1.0 { weight } else { loads };
        interpolated(&inverse[from.unwrap_or(0)..], wanted)[1]
    }
}

/// The values at `x` of a table of (x, values), with straight lines between.
pub(crate) fn interpolated<const N: usize>(table: &[[f64; N]], x: f64) -> [f64; N] {
    let (from, to, fraction) = piece(table, |row| row[0], x);
    std::array::from_fn(|i| from[i] + fraction * (to[i] - from[i]))
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
        let of = |weight, loads| history.lambda_of(weight, loads);
        assert!((of(0.5, 0.0) - 0.05).abs() < 1e-15 && (of(1.0, 0.5) - 0.55).abs() < 1e-15);
        assert_eq!([of(1.0, 0.0), of(1.0, 1.0)], [0.1, 1.0]);
    }
}
