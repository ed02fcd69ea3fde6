//! Conditions on the values of a scene besides the ranges of its keys, which stand on their fields.
//!
//! The ranges are wider than the ranges of any real sheet, and narrower than an error by a factor
//! of 1000.

use crate::actuation::{At, Attached, EdgeLoadConfig, SupportKind};
use crate::invalid_scene::InvalidScene;
use crate::keys::SceneConfig;
use crate::level::Level;
use crate::posture::Posture;
use crate::sheet_config::SheetConfig;
use crate::solved_hinges::SolvedHingesError;
use crate::target::Target;
use design::geometry::polygon::{distance, distance_to_outline, edges, mean};
use design::geometry::region::Region;
use design::pattern::cut_pattern::CutPattern;
use design::sheet::panel::boundary;
use design::sheet::topology::Topology;
use hinge::InvalidDesign;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::FRAC_PI_2;
use support::key_limits::{self, within};

/// Distance of a point on the edge of a panel from it (mm).
const ON_EDGE: f64 = 1e-6;

/// Checks the keys that say which files are read.
pub(super) fn keys(scene: &SceneConfig) -> Result<(), InvalidScene> {
    key_limits::check::<SceneConfig>(scene)?;
    level(scene)?;
    title(scene)?;
    sheet(scene)
}

/// Checks everything else that needs no file but the cells of the sheet.
pub(super) fn config(scene: &SceneConfig, topology: &Topology) -> Result<(), InvalidScene> {
    ligament(scene)?;
    start(scene, topology)?;
    posture(scene)?;
    supports(scene, topology)?;
    loads(scene, topology)?;
    attachments(scene, topology)?;
    objective(scene)
}

/// An error if the level reads a file that the scene does not name.
pub(super) fn level(scene: &SceneConfig) -> Result<(), InvalidScene> {
    if !scene.level.is_learned() {
        return Ok(());
    }
    let Some(files) = &scene.surrogate else {
        return Err(InvalidScene::NoSection("surrogate"));
    };
    match scene.level {
        Level::Draft if files.draft.is_none() => Err(InvalidScene::NoDraft),
        Level::Fine if files.ensemble.is_empty() => Err(InvalidScene::NoEnsemble),
        Level::Final if files.solved_hinges.is_none() => Err(SolvedHingesError::NoFile.into()),
        _ => Ok(()),
    }
}

/// Maximum ratio of the target's perimeter to the perimeter of the flat sheet. Panels keep their
/// edges: a sheet of squares opens to twice its width; a sheet of slender panels opens further, but
/// along one axis only.
const OPENS_TO: f64 = 3.0;

/// Maximum distance between the middles of target and flat sheet (mm): supports move a sheet by 100
/// m at most.
const AWAY: f64 = 1e6;

/// Area of the sampled target over the square of its length below which it has no inside.
const NO_AREA: f64 = 1e-6;

/// A target of a very different size than the sheet, or far away from it, is assumed to be in the
/// wrong unit.
pub(super) fn target(target: &Target, scene: &SceneConfig) -> Result<(), InvalidScene> {
    let outline = scene.sheet.outline();
    let perimeter: f64 = edges(&outline.corners).map(|(p, q)| distance(p, q)).sum();
    let limits = [0.2 * perimeter, OPENS_TO * perimeter];
    within("length of the target outline", target.length, limits, "mm")
        .map_err(|source| InvalidScene::TargetLength { source, perimeter })?;
    let away = distance(target.mean(), mean(&outline.corners));
    within("distance of the target from the sheet", away, [0.0, AWAY], "mm")?;
    let objective = &scene.objective;
    let needs_area = objective.symmetric_difference > 0.0 || scene.level == Level::Pin;
    if needs_area && target.area() <= NO_AREA * target.length * target.length {
        return Err(InvalidScene::TargetWithoutArea);
    }
    Ok(())
}

/// The title is written to SVG pictures, which must not contain control characters.
fn title(scene: &SceneConfig) -> Result<(), InvalidScene> {
    let control = scene.title.chars().find(|c| c.is_control());
    control.map_or(Ok(()), |c| Err(InvalidScene::Title(c)))
}

fn sheet(scene: &SceneConfig) -> Result<(), InvalidScene> {
    let SheetConfig { size, corners, .. } = &scene.sheet;
    if size.is_some() == corners.is_some() {
        return Err(InvalidScene::SizeOrCorners);
    }
    let outline = scene.sheet.outline();
    outline.check().map_err(InvalidScene::Corners)?;
    within("the size of sheet.corners", outline.size(), [20.0, 2e4], "mm")?;
    let [columns, rows] = scene.sheet.panels;
    if columns.saturating_mul(rows) > 100_000 {
        return Err(InvalidScene::Panels { columns, rows });
    }
    Ok(())
}

fn ligament(scene: &SceneConfig) -> Result<(), InvalidScene> {
    let (ligament, process) = (&scene.ligament, &scene.process);
    let [min, max] = ligament.range;
    for w_lig in [min, max] {
        let design = process.hinge(w_lig, FRAC_PI_2);
        let refuse = |source| match source {
            InvalidDesign::Kerf { kerf: slit, limit: hole } => InvalidScene::Slit { slit, hole },
            source => InvalidScene::Hinge { w_lig, source },
        };
        design.validate().map_err(refuse)?;
    }
    let slit = process.slit_width;
    let kerf = scene.cutting.tool_kerf(slit);
    if !(kerf > 0.0 && kerf <= slit) {
        return Err(InvalidScene::Kerf { kerf, slit });
    }
    let outline = scene.sheet.outline();
    let size = outline.size();
    within("process.r_win", process.r_win, [0.0, 10.0 * size], "mm")
        .map_err(|source| InvalidScene::Window { source, size })?;
    if min >= max {
        return Err(InvalidScene::LigamentRange { min, max });
    }
    let start = ligament.start;
    if !(start > min && start < max) {
        let key = "ligament.start";
        let w_lig = start;
        return Err(InvalidScene::Width { key, w_lig, min, max });
    }
    // A slit is at most as long as two panels and is shortened at each end by a ligament and its
    // hole.
    let panel = scene.sheet.mean_panel_area().sqrt();
    let taken = min + process.hole_radius(min);
    if taken >= panel {
        return Err(InvalidScene::NoSlit { min, taken, panel });
    }
    Ok(())
}

fn start(scene: &SceneConfig, topology: &Topology) -> Result<(), InvalidScene> {
    let start = &scene.start;
    start.pattern(topology.grid).map_err(InvalidScene::Start)?;
    let Some(w_lig) = &start.w_lig else {
        return Ok(());
    };
    let (found, hinges) = (w_lig.len(), topology.hinge_count());
    if found != hinges {
        return Err(InvalidScene::StartWidths { found, hinges });
    }
    let [min, max] = scene.ligament.range;
    let beyond = w_lig.iter().find(|w| !(**w > min && **w < max));
    let key = "start.w_lig";
    beyond.map_or(Ok(()), |&w_lig| Err(InvalidScene::Width { key, w_lig, min, max }))
}

fn posture(scene: &SceneConfig) -> Result<(), InvalidScene> {
    let Some(posture) = &scene.posture else {
        let learned = scene.level.is_learned();
        return if learned { Err(InvalidScene::NoPosture) } else { Ok(()) };
    };
    let hangs = posture.kind == Posture::Hanging;
    if posture.down.is_some() && !hangs {
        return Err(InvalidScene::OtherPosture(posture.kind));
    }
    if hangs && posture.down().is_none() {
        return Err(InvalidScene::NoDown);
    }
    Ok(())
}

/// The points at which panels are held or pulled: one for each panel, inside it in the start
/// pattern, with one hole or clip.
fn attachments(scene: &SceneConfig, topology: &Topology) -> Result<(), InvalidScene> {
    let (mut points, mut fastened) = (BTreeMap::new(), BTreeSet::new());
    for attached in scene.attached() {
        let Attached { panel, at, .. } = attached;
        if points.insert(panel, at).is_some_and(|other| other != at) {
            return Err(InvalidScene::TwoPoints { panel });
        }
        let has_fastening = attached.hole.or(attached.clip).is_some();
        if has_fastening && !fastened.insert(panel) {
            return Err(InvalidScene::TwoFastenings { panel });
        }
        fastening(scene, topology, &attached)?;
        inside(scene, topology, attached.key, panel, at)?;
    }
    for (panel, at) in points {
        let loaded =
            |edge: &EdgeLoadConfig| edge.edge.panels(topology).contains(&topology.number(panel));
        if at != At::default() && scene.edge_loads.iter().any(loaded) {
            return Err(InvalidScene::EdgeAndPoint { panel });
        }
    }
    Ok(())
}

/// A clip is on an edge of the sheet, a hole inside its panel and wider than the kerf.
fn fastening(
    scene: &SceneConfig,
    topology: &Topology,
    attached: &Attached,
) -> Result<(), InvalidScene> {
    let key = attached.key.clone();
    let edge = attached.at.edge();
    if attached.clip.is_some() {
        let panel = attached.panel;
        let Some(edge) = edge else {
            return Err(InvalidScene::ClipOffEdge { key });
        };
        if !edge.panels(topology).contains(&topology.number(panel)) {
            return Err(InvalidScene::ClipInside { key, panel });
        }
    }
    if let Some(hole) = attached.hole {
        if edge.is_some() {
            return Err(InvalidScene::HoleOnEdge { key });
        }
        let kerf = scene.cutting.tool_kerf(scene.process.slit_width);
        if hole <= kerf {
            return Err(InvalidScene::HoleBelowKerf { key, hole, kerf });
        }
    }
    Ok(())
}

fn inside(
    scene: &SceneConfig,
    topology: &Topology,
    key: String,
    panel: [usize; 2],
    at: At,
) -> Result<(), InvalidScene> {
    let At::Point(at) = at else {
        return Ok(());
    };
    let grid = topology.grid;
    let start = scene.start.pattern(grid).map_err(InvalidScene::Start)?;
    let pattern = CutPattern::new(grid, scene.sheet.outline(), &start);
    let pattern = pattern.map_err(InvalidScene::Start)?;
    let endpoints = topology.endpoints[topology.number(panel)];
    let corners = endpoints.map(|endpoint| pattern.points[endpoint]);
    let boundary = boundary(&corners, topology.trims[topology.number(panel)].as_ref());
    if distance_to_outline(at, &boundary) < ON_EDGE
        || Region::union_of(vec![boundary.clone()]).contains(at)
    {
        return Ok(());
    }
    let corners: Vec<_> = boundary.iter().map(|[x, y]| format!("({x:.1}, {y:.1})")).collect();
    let corners = corners.join(" ");
    Err(InvalidScene::PointOutside { key, at, panel, corners })
}

fn supports(scene: &SceneConfig, topology: &Topology) -> Result<(), InvalidScene> {
    if scene.supports.is_empty() && scene.level != Level::Pin {
        return Err(InvalidScene::NoSupports);
    }
    for (i, support) in scene.supports.iter().enumerate() {
        let at = support.panel;
        panel(topology, || format!("supports[{i}].panel"), at)?;
        if scene.supports[..i].iter().any(|other| other.panel == at) {
            return Err(InvalidScene::SupportedTwice { i, panel: at });
        }
        let mut motions = support.motion().into_iter().zip(support.kind.holds());
        if motions.any(|(motion, held)| motion != 0.0 && !held) {
            return Err(InvalidScene::FreeMotion { i });
        }
        if support.clip.is_some() && support.kind != SupportKind::Clamp {
            return Err(InvalidScene::ClipTurns { i });
        }
    }
    Ok(())
}

fn loads(scene: &SceneConfig, topology: &Topology) -> Result<(), InvalidScene> {
    for (i, load) in scene.loads.iter().enumerate() {
        panel(topology, || format!("loads[{i}].panel"), load.panel)?;
        let down = scene.posture.and_then(|posture| posture.down());
        if load.mass_g.is_some() && down.is_none() {
            return Err(InvalidScene::NoGravity { i });
        }
        let mut supports = scene.supports.iter();
        let support = supports.find(|support| support.panel == load.panel);
        let values = load.values(down);
        let held = support.map_or([false; 3], |support| support.kind.holds());
        let mut held = held.iter().zip(values);
        if held.any(|(held, value)| *held && value != 0.0) {
            let panel = load.panel;
            return Err(InvalidScene::HeldLoad { i, panel });
        }
    }
    for (i, load) in scene.opening_couples.iter().enumerate() {
        let Some(panels) = load.panels else {
            continue;
        };
        for at in panels {
            panel(topology, || format!("opening_couples[{i}].panels"), at)?;
        }
        let [first, second] = panels;
        if first[0].abs_diff(second[0]) + first[1].abs_diff(second[1]) != 1 {
            return Err(InvalidScene::NoNeighbours { i, panels });
        }
    }
    Ok(())
}

fn objective(scene: &SceneConfig) -> Result<(), InvalidScene> {
    let (key, width) = ("objective.min_panel_width", scene.objective.min_panel_width);
    let side = scene.sheet.mean_panel_area().sqrt();
    within(key, width, [0.0, side / 3.0], "mm")?;
    Ok(())
}

/// A panel that a key names must be one of the sheet.
fn panel(
    topology: &Topology,
    key: impl Fn() -> String,
    panel: [usize; 2],
) -> Result<(), InvalidScene> {
    if topology.panel(panel[0], panel[1]).is_some() {
        return Ok(());
    }
    let (key, grid) = (key(), [topology.grid.m, topology.grid.n]);
    Err(InvalidScene::NoPanel { key, panel, grid })
}
