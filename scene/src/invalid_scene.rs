//! Why the values of a scene do not fit each other.

use crate::posture::Posture;
use crate::solved_hinges::SolvedHingesError;
use crate::springback_file::SpringbackFileError;
use crate::target::TargetError;
use design::equilibrium::tangent::MIN_PIVOT_RATIO;
use hinge::InvalidDesign;
use std::path::PathBuf;
use support::Fault;

/// A value of a scene that is outside its range or that other values exclude; the message names the
/// key.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum InvalidScene {
    #[error(transparent)]
    Fault(#[from] Fault),
    #[error("{source} (the outline of the flat sheet is {perimeter:.0} mm long)")]
    TargetLength { source: Fault, perimeter: f64 },
    #[error(transparent)]
    Target(#[from] TargetError),
    #[error("title contains the control character {0:?}: remove it")]
    Title(char),
    #[error("sheet: give either size or corners")]
    SizeOrCorners,
    #[error("sheet.corners: {0}")]
    Corners(Fault),
    #[error("sheet.panels = [{columns}, {rows}] violates columns * rows <= 100000")]
    Panels { columns: usize, rows: usize },
    #[error("ligament.range and process, at w_lig = {w_lig} mm: {source}")]
    Hinge { w_lig: f64, source: InvalidDesign },
    #[error(
        "process.slit_width = {slit} mm violates 0 < slit_width < {hole} mm, the diameter of the smallest hole: the slit ends in it"
    )]
    Slit { slit: f64, hole: f64 },
    #[error(
        "cutting.kerf = {kerf} mm violates 0 < kerf <= process.slit_width = {slit} mm: no tool cuts a slit narrower than it removes"
    )]
    Kerf { kerf: f64, slit: f64 },
    #[error("{source} (a window is a part of the sheet, which is {size:.0} mm large)")]
    Window { source: Fault, size: f64 },
    #[error("ligament.range = [{min}, {max}] mm violates minimum < maximum")]
    LigamentRange { min: f64, max: f64 },
    #[error("{key} = {w_lig} mm violates {min} < {key} < {max} mm (ligament.range)")]
    Width { key: &'static str, w_lig: f64, min: f64, max: f64 },
    #[error(
        "ligament.range: ligaments of {min} mm with their holes take {taken:.1} mm, but panels are {panel:.1} mm wide on \
         average, so no slit is left: narrow the ligaments or use fewer panels"
    )]
    NoSlit { min: f64, taken: f64, panel: f64 },
    #[error("start: {0}")]
    Start(Fault),
    #[error("start.w_lig has {found} entries; the sheet has {hinges} hinges")]
    StartWidths { found: usize, hinges: usize },
    #[error(
        "posture: say what keeps the panels in their plane: [posture] with kind = \"held-flat\" (plates, a frame), \
         \"lying\" (on a horizontal surface), \"hanging\" (upright) or \"free\""
    )]
    NoPosture,
    #[error(
        "posture.down: a hanging sheet needs the direction of gravity in its plane, such as down = [0.0, -1.0]"
    )]
    NoDown,
    #[error(
        "posture.down is not valid for the kind {0:?}: only in a hanging sheet gravity acts in the plane. Remove the key or \
         change `kind`"
    )]
    OtherPosture(Posture),
    #[error(
        "loads[{i}].mass_g: a weight pulls along gravity, which is in the plane of a hanging sheet only: set \
         posture.kind = \"hanging\" with `down`, or give a force"
    )]
    NoGravity { i: usize },
    #[error(
        "panel {panel:?} is held or pulled at two points: give its supports and loads the same `at`"
    )]
    TwoPoints { panel: [usize; 2] },
    #[error(
        "edge_loads act at the centroids of the panels of their edge, but panel {panel:?} has a support or a load at \
         another point: remove its `at`, or load the panels of the edge by [[loads]]"
    )]
    EdgeAndPoint { panel: [usize; 2] },
    #[error(
        "{key}.clip: a clip holds an edge: set at = \"bottom\", \"right\", \"top\" or \"left\""
    )]
    ClipOffEdge { key: String },
    #[error(
        "{key}.clip: a clip holds an edge of the sheet, and this edge of panel {panel:?} is inside: clip another panel or edge"
    )]
    ClipInside { key: String, panel: [usize; 2] },
    #[error(
        "{key}.hole: a hole at the edge of a panel would be open: set `at` to a point [x, y] inside the panel, or use a clip"
    )]
    HoleOnEdge { key: String },
    #[error(
        "{key}.hole = {hole} mm violates hole > {kerf} mm, the kerf of the tool (cutting.kerf)"
    )]
    HoleBelowKerf { key: String, hole: f64, kerf: f64 },
    #[error(
        "panel {panel:?} has two holes or clips at one point: give one of its supports and loads a hole or a clip"
    )]
    TwoFastenings { panel: [usize; 2] },
    #[error("supports[{i}].clip: a clip keeps its panel from turning: set kind = \"clamp\"")]
    ClipTurns { i: usize },
    #[error(
        "{key}.at = [{}, {}] mm is outside panel {panel:?} of the start, which has the corners {corners}",
        at[0], at[1]
    )]
    PointOutside { key: String, at: [f64; 2], panel: [usize; 2], corners: String },
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
    NoPanel { key: String, panel: [usize; 2], grid: [usize; 2] },
    #[error("the level of the scene needs the section [{0}]")]
    NoSection(&'static str),
    #[error(
        "the level `draft` reads a smaller network: name it (surrogate.draft), train one (`kirigami train DATABASE --config \
         configs/training/small.toml`), or use level = \"standard\""
    )]
    NoDraft,
    #[error(
        "the level `fine` takes the mean of several networks: name the further ones (surrogate.ensemble), train them (`kirigami train \
         DATABASE --seeds 4`), or use level = \"standard\""
    )]
    NoEnsemble,
    #[error(
        "surrogate.weights: there is no file {}: train it, or give the constants of level = \"linear\"",
        file.display()
    )]
    NoWeights { file: PathBuf },
    #[error("the weights {} are for {source}", file.display())]
    OtherHinges { file: PathBuf, source: WeightsMismatch },
    #[error("surrogate.ensemble: all networks must be trained on the data of surrogate.weights")]
    OtherTraining,
    #[error(
        "surrogate.ensemble: {} and {} are the same network, whose spread is zero: name networks of other seeds",
        files[0].display(), files[1].display()
    )]
    SameNetwork { files: [PathBuf; 2] },
    #[error(transparent)]
    Springback(#[from] SpringbackFileError),
    #[error(transparent)]
    SolvedHinges(#[from] SolvedHingesError),
    #[error(
        "linear.k_theta is {ratio:.0e} times the greater of linear.k_a and linear.k_s times the area of a panel: below \
         {MIN_PIVOT_RATIO:.0e} rotations are lost in the rounding of the translations. Raise k_theta, or lower k_a and k_s"
    )]
    Soft { ratio: f64 },
    #[error(
        "supports, loads, edge_loads, opening_couples, drive: level = \"pin\" has no equilibrium: remove these \
         sections, or use level = \"linear\""
    )]
    HeldPins,
    #[error(
        "the target encloses no area, which objective.symmetric_difference and the centre of a sheet on pins need: give it an \
         inside"
    )]
    TargetWithoutArea,
    #[error("objective.domain needs level = \"standard\": no other law has a domain")]
    NoDomain,
    #[error(
        "objective.damage_measure = \"peak\": the weights do not predict D_peak: use \"mean\", or train on a database \
         that contains it"
    )]
    NoPeakDamage,
    #[error(
        "objective.damage: only the learned hinge law predicts damage: use level = \"standard\" or damage = 0"
    )]
    NoDamage,
}

/// One radius of holes over w_lig, or the range of several.
fn ratios([least, most]: [f64; 2]) -> String {
    if least == most { format!("{least}") } else { format!("{least:.3} to {most:.3}") }
}

/// What weights are for, if not for the hinges of the scene.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum WeightsMismatch {
    #[error(
        "another material law than the scene: `{trained}` ({trained_law}; the file `{file}` has {law}). Name \
         the material file of the training, with its thickness; the key `thickness` of the scene gives the sheet another. \
         If its numbers have changed, train again"
    )]
    Law { trained: String, trained_law: String, file: String, law: String },
    #[error("the material `{trained}`, the scene's is `{file}`")]
    Material { trained: String, file: String },
    #[error(
        "ligaments of {:.2} to {:.2} thicknesses, but ligament.range of the scene is {:.2} to {:.2} thicknesses of its sheet: \
         ligaments no wider than the sheet is thick bend in its plane, wider ones buckle, and no law holds for both. \
         Change ligament.range or the weights",
        trained[0], trained[1], range[0], range[1]
    )]
    Regime { trained: [f64; 2], range: [f64; 2] },
    #[error(
        "holes with a radius of {} w_lig, but the scene has {}: change `fillet_ratio` or `hole_diameter` in [process], \
         or name weights for such holes",
        ratios(*trained), ratios(*scene)
    )]
    Holes { trained: [f64; 2], scene: [f64; 2] },
    #[error(
        "windows of r_win = {trained} mm in a sheet of this thickness, but the scene has process.r_win = {scene}"
    )]
    Window { trained: f64, scene: f64 },
}
