//! Why the values of a scene do not fit each other.

use crate::equilibrium::solver::EquilibriumError;
use crate::objective::design_problem::DesignError;
use crate::objective::target::TargetError;
use crate::pattern::pattern_error::PatternError;
use crate::scene::invalid_hinge::InvalidHinge;
use hinge::{InvalidDesign, InvalidMaterial};
use support::key_limits::OutOfRange;

/// A value of a scene that is outside its range or that other values exclude; the message names the key.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum InvalidScene {
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    #[error("{source} (the outline of the flat sheet is {perimeter:.0} mm long)")]
    TargetLength { source: OutOfRange, perimeter: f64 },
    #[error(transparent)]
    Hinges(#[from] InvalidHinge),
    #[error(transparent)]
    Target(#[from] TargetError),
    #[error(transparent)]
    Equilibrium(#[from] EquilibriumError),
    #[error("objective.balance needs the gradients at the start: {0}")]
    Balance(DesignError),
    #[error(transparent)]
    Material(#[from] InvalidMaterial),
    #[error("title contains the control character {0:?}: remove it")]
    Title(char),
    #[error("sheet: give either size or corners")]
    SizeOrCorners,
    #[error("sheet.corners: {0}")]
    Corners(PatternError),
    #[error("sheet.panels = [{columns}, {rows}] violates columns * rows <= 100000")]
    Panels { columns: usize, rows: usize },
    #[error("ligament.range and process, at w_lig = {w_lig} mm: {source}")]
    Hinge { w_lig: f64, source: InvalidDesign },
    #[error("{source} (a window is a part of the sheet, which is {size:.0} mm large)")]
    Window { source: OutOfRange, size: f64 },
    #[error("ligament.range = [{min}, {max}] mm violates minimum < maximum")]
    LigamentRange { min: f64, max: f64 },
    #[error("{key} = {w_lig} mm violates {min} < {key} < {max} mm (ligament.range)")]
    Width {
        key: &'static str,
        w_lig: f64,
        min: f64,
        max: f64,
    },
    #[error(
        "ligament.range: ligaments of {min} mm with their holes take {taken:.1} mm, but panels are {panel:.1} mm wide on \
         average, so no slit is left: narrow the ligaments or use fewer panels"
    )]
    NoSlit { min: f64, taken: f64, panel: f64 },
    #[error("start: {0}")]
    Start(PatternError),
    #[error("start.w_lig has {found} entries; the sheet has {hinges} hinges")]
    StartWidths { found: usize, hinges: usize },
    #[error("supports: a sheet without supports has no equilibrium: add [[supports]]")]
    NoSupports,
    #[error("supports[{i}].panel = {panel:?} is supported twice")]
    SupportedTwice { i: usize, panel: [usize; 2] },
    #[error(
        "supports[{i}] prescribes a motion that a support of its kind leaves free: change kind, displacement or \
         rotation_deg"
    )]
    FreeMotion { i: usize },
    #[error(
        "loads[{i}]: the support of panel {panel:?} prevents the motion of this load, which does no work: remove it"
    )]
    HeldLoad { i: usize, panel: [usize; 2] },
    #[error("opening_couples[{i}].panels = {panels:?} are not neighbours")]
    NoNeighbours { i: usize, panels: [[usize; 2]; 2] },
    #[error(
        "{key} = {panel:?} violates column < {} and row < {} (panels are counted from [0, 0] at the lower left)",
        grid[0], grid[1]
    )]
    NoPanel {
        key: String,
        panel: [usize; 2],
        grid: [usize; 2],
    },
}
