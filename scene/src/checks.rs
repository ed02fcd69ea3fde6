//! Conditions on the values of a scene besides the ranges of its keys, which stand on their fields.
//!
//! The ranges are wider than the ranges of any real sheet, and narrower than an error by a factor
//! of 1000.

use crate::{
    actuation::{At, Attached, SheetEdge, SupportKind},
    keys::SceneConfig,
    level::Level,
    posture::Posture,
    sheet_config::SheetConfig,
    solved_hinges,
    target::Target,
};
use design::{
    geometry::polygon::{bounds, distance, distance_to_polygon, edges, mean, size},
    pattern::cut_pattern::CutPattern,
    sheet::{panel::boundary, topology::Topology},
};
use hinge::InvalidDesign;
use std::{
    collections::{BTreeMap, BTreeSet},
    f64::consts::FRAC_PI_2,
};
use support::{
    Fault, at, ensure, fault,
    key_limits::{self, within},
    refuse,
};

/// Distance of a point on the edge of a panel from it (mm).
pub const ON_EDGE: f64 = 1e-6;

/// Checks the keys that say which files are read.
pub(super) fn keys(scene: &SceneConfig) -> Result<(), Fault> {
    key_limits::check::<SceneConfig>(scene)?;
    level(scene)?;
    // The title is written to SVG pictures, which must not contain control characters.
    if let Some(control) = scene.title.chars().find(|c| c.is_control()) {
        refuse!("title contains the control character {control:?}: remove it");
    }
    sheet(scene)
}

/// Checks everything else that needs no file but the cells of the sheet.
pub(super) fn config(scene: &SceneConfig, topology: &Topology) -> Result<(), Fault> {
    ligament(scene)?;
    start(scene, topology)?;
    posture(scene)?;
    supports(scene, topology)?;
    loads(scene, topology)?;
    attachments(scene, topology)?;
    let (key, width) = ("objective.min_panel_width", scene.objective.min_panel_width);
    let side = scene.sheet.mean_panel_area().sqrt();
    within(key, width, [0.0, side / 3.0], "mm")
}

/// An error if the level reads a file that the scene does not name.
pub(super) fn level(scene: &SceneConfig) -> Result<(), Fault> {
    if !scene.level.is_learned() {
        return Ok(());
    }
    let files = scene.surrogate.as_ref().ok_or_else(|| no_section("surrogate"))?;
    match scene.level {
        Level::Draft if files.draft.is_none() => refuse!(
            "the level `draft` reads a smaller network: name it (surrogate.draft), train one (`kirigami train DATABASE --config \
             configs/training/small.toml`), or use level = \"standard\""
        ),
        Level::Fine if files.ensemble.is_empty() => refuse!(
            "the level `fine` takes the mean of several networks: name the further ones (surrogate.ensemble), train them (`kirigami train \
             DATABASE --seeds 4`), or use level = \"standard\""
        ),
        Level::Final if files.solved_hinges.is_none() => Err(solved_hinges::no_file()),
        _ => Ok(()),
    }
}

/// The error of a scene without a section that its level reads.
pub(super) fn no_section(name: &str) -> Fault {
    fault!("the level of the scene needs the section [{name}]")
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
pub(super) fn target(target: &Target, scene: &SceneConfig) -> Result<(), Fault> {
    let outline = scene.sheet.outline();
    let perimeter: f64 = edges(&outline.corners).map(|(p, q)| distance(p, q)).sum();
    let [width, height] = size(bounds(target.points.iter().copied()));
    // Limbs lengthen an outline, and not the box around it.
    let length = target.length.min(2.0 * (width + height));
    let limits = [0.2 * perimeter, OPENS_TO * perimeter];
    within("length of the target outline", length, limits, "mm").map_err(|error| {
        format!("{error} (the outline of the flat sheet is {perimeter:.0} mm long)")
    })?;
    let away = distance(target.mean(), mean(&outline.corners));
    within("distance of the target from the sheet", away, [0.0, AWAY], "mm")?;
    let objective = &scene.objective;
    let needs_area = objective.symmetric_difference > 0.0 || scene.level == Level::Pin;
    ensure!(
        !needs_area || target.area() > NO_AREA * target.length * target.length,
        "the target encloses no area, which objective.symmetric_difference and the centre of a sheet on pins need: give it an \
         inside"
    );
    Ok(())
}

fn sheet(scene: &SceneConfig) -> Result<(), Fault> {
    let SheetConfig { size, corners, panels: [columns, rows] } = scene.sheet;
    ensure!(size.is_some() != corners.is_some(), "sheet: give either size or corners");
    let outline = scene.sheet.outline();
    outline.check().map_err(at("sheet.corners"))?;
    within("the size of sheet.corners", outline.size(), [20.0, 2e4], "mm")?;
    ensure!(
        columns.saturating_mul(rows) <= 100_000,
        "sheet.panels = [{columns}, {rows}] violates columns * rows <= 100000"
    );
    Ok(())
}

fn ligament(scene: &SceneConfig) -> Result<(), Fault> {
    let (ligament, process) = (&scene.ligament, &scene.process);
    let [min, max] = ligament.range;
    let slit = process.slit_width;
    for w_lig in [min, max] {
        match process.hinge(w_lig, FRAC_PI_2).validate() {
            Ok(()) => {}
            Err(InvalidDesign::Kerf { kerf, limit }) => refuse!(
                "process.slit_width = {kerf} mm violates 0 < slit_width < {limit} mm, the diameter of the smallest hole: the slit ends in it"
            ),
            Err(error) => refuse!("ligament.range and process, at w_lig = {w_lig} mm: {error}"),
        }
    }
    let kerf = scene.cutting.tool_kerf(slit);
    ensure!(
        kerf > 0.0 && kerf <= slit,
        "cutting.kerf = {kerf} mm violates 0 < kerf <= process.slit_width = {slit} mm: no tool cuts a slit narrower than it removes"
    );
    let size = scene.sheet.outline().size();
    within("process.r_win", process.r_win, [0.0, 10.0 * size], "mm").map_err(|error| {
        format!("{error} (a window is a part of the sheet, which is {size:.0} mm large)")
    })?;
    ensure!(min < max, "ligament.range = [{min}, {max}] mm violates minimum < maximum");
    width(scene, "ligament.start", ligament.start)?;
    // A slit is at most as long as two panels and is shortened at each end by a ligament and its
    // hole.
    let panel = scene.sheet.mean_panel_area().sqrt();
    let taken = min + process.hole_radius(min);
    ensure!(
        taken < panel,
        "ligament.range: ligaments of {min} mm with their holes take {taken:.1} mm, but panels are {panel:.1} mm wide on \
         average, so no slit is left: narrow the ligaments or use fewer panels"
    );
    Ok(())
}

/// A width (mm) that is inside the range of the chart.
fn width(scene: &SceneConfig, key: &str, w_lig: f64) -> Result<(), Fault> {
    let [min, max] = scene.ligament.range;
    ensure!(
        w_lig > min && w_lig < max,
        "{key} = {w_lig} mm violates {min} < {key} < {max} mm (ligament.range)"
    );
    Ok(())
}

fn start(scene: &SceneConfig, topology: &Topology) -> Result<(), Fault> {
    let start = &scene.start;
    start.pattern(topology.grid).map_err(at("start"))?;
    let w_lig = start.w_lig.as_deref().unwrap_or_default();
    let (found, hinges) = (w_lig.len(), topology.hinge_count());
    ensure!(
        start.w_lig.is_none() || found == hinges,
        "start.w_lig has {found} entries; the sheet has {hinges} hinges"
    );
    w_lig.iter().try_for_each(|w_lig| width(scene, "start.w_lig", *w_lig))
}

fn posture(scene: &SceneConfig) -> Result<(), Fault> {
    let Some(posture) = &scene.posture else {
        ensure!(
            !scene.level.is_learned(),
            "posture: say what keeps the panels in their plane: [posture] with kind = \"held-flat\" (plates, a frame), \
             \"lying\" (on a horizontal surface), \"hanging\" (upright) or \"free\""
        );
        return Ok(());
    };
    let hangs = posture.kind == Posture::Hanging;
    ensure!(
        hangs || posture.down.is_none(),
        "posture.down: only a hanging sheet has gravity in its plane: remove the key or change `kind`"
    );
    ensure!(
        !hangs || posture.down().is_some(),
        "posture.down: a hanging sheet needs the direction of gravity in its plane, such as down = [0.0, -1.0]"
    );
    Ok(())
}

/// The points at which panels are held or pulled: one for each panel, inside it in the start
/// pattern, with one hole or clip.
fn attachments(scene: &SceneConfig, topology: &Topology) -> Result<(), Fault> {
    let (mut points, mut fastened) = (BTreeMap::new(), BTreeSet::new());
    for attached in scene.attached() {
        let Attached { panel, at, hole, clip, .. } = attached;
        ensure!(
            points.insert(panel, at).is_none_or(|other| other == at),
            "panel {panel:?} is held or pulled at two points: give its supports and loads the same `at`"
        );
        ensure!(
            hole.or(clip).is_none() || fastened.insert(panel),
            "panel {panel:?} has two holes or clips at one point: give one of its supports and loads a hole or a clip"
        );
        fastening(scene, topology, &attached)?;
        inside(scene, topology, &attached)?;
    }
    for (panel, at) in points {
        let mut edges = scene.edge_loads.iter();
        ensure!(
            at == At::default() || !edges.any(|load| is_on(topology, load.edge, panel)),
            "edge_loads act at the centroids of the panels of their edge, but panel {panel:?} has a support or a load at \
             another point: remove its `at`, or load the panels of the edge by [[loads]]"
        );
    }
    Ok(())
}

/// Whether a panel is one of those along an edge of the sheet.
fn is_on(topology: &Topology, edge: SheetEdge, panel: [usize; 2]) -> bool {
    edge.panels(topology).contains(&topology.number(panel))
}

/// A clip is on an edge of the sheet, a hole inside its panel and wider than the kerf.
fn fastening(scene: &SceneConfig, topology: &Topology, attached: &Attached) -> Result<(), Fault> {
    let Attached { key, panel, at, hole, clip, .. } = attached;
    let edge = at.edge();
    ensure!(
        clip.is_none() || edge.is_some(),
        "{key}.clip: a clip holds an edge: set at = \"bottom\", \"right\", \"top\" or \"left\""
    );
    ensure!(
        clip.is_none() || edge.is_some_and(|edge| is_on(topology, edge, *panel)),
        "{key}.clip: a clip holds an edge of the sheet, and this edge of panel {panel:?} is inside: clip another panel or edge"
    );
    let Some(hole) = hole else {
        return Ok(());
    };
    ensure!(
        edge.is_none(),
        "{key}.hole: a hole at the edge of a panel would be open: set `at` to a point [x, y] inside the panel, or use a clip"
    );
    let kerf = scene.cutting.tool_kerf(scene.process.slit_width);
    ensure!(
        *hole > kerf,
        "{key}.hole = {hole} mm violates hole > {kerf} mm, the kerf of the tool (cutting.kerf)"
    );
    Ok(())
}

fn inside(scene: &SceneConfig, topology: &Topology, attached: &Attached) -> Result<(), Fault> {
    let Attached { key, panel, at: At::Point(place), .. } = attached else {
        return Ok(());
    };
    let (grid, number) = (topology.grid, topology.number(*panel));
    let start = scene.start.pattern(grid).map_err(at("start"))?;
    let pattern = CutPattern::new(grid, scene.sheet.outline(), &start).map_err(at("start"))?;
    let corners = topology.endpoints[number].map(|endpoint| pattern.points[endpoint]);
    let boundary = boundary(&corners, topology.trims[number].as_ref());
    let corners: Vec<_> = boundary.iter().map(|[x, y]| format!("({x:.1}, {y:.1})")).collect();
    ensure!(
        distance_to_polygon(*place, &boundary) < ON_EDGE,
        "{key}.at = [{}, {}] mm is outside panel {panel:?} of the start, which has the corners {}",
        place[0],
        place[1],
        corners.join(" ")
    );
    Ok(())
}

fn supports(scene: &SceneConfig, topology: &Topology) -> Result<(), Fault> {
    ensure!(
        !scene.supports.is_empty() || scene.level == Level::Pin,
        "supports: a sheet without supports has no equilibrium: add [[supports]]"
    );
    for (i, support) in scene.supports.iter().enumerate() {
        let panel = support.panel;
        check_panel(topology, &format!("supports[{i}].panel"), panel)?;
        ensure!(
            !scene.supports[..i].iter().any(|other| other.panel == panel),
            "supports[{i}].panel = {panel:?} is supported twice"
        );
        let mut motions = support.motion().into_iter().zip(support.kind.holds());
        ensure!(
            motions.all(|(motion, held)| motion == 0.0 || held),
            "supports[{i}] prescribes a motion that a support of its kind leaves free: change kind, displacement or \
             rotation_deg"
        );
        ensure!(
            support.clip.is_none() || support.kind == SupportKind::Clamp,
            "supports[{i}].clip: a clip keeps its panel from turning: set kind = \"clamp\""
        );
    }
    Ok(())
}

fn loads(scene: &SceneConfig, topology: &Topology) -> Result<(), Fault> {
    let down = scene.posture.and_then(|posture| posture.down());
    for (i, load) in scene.loads.iter().enumerate() {
        let panel = load.panel;
        check_panel(topology, &format!("loads[{i}].panel"), panel)?;
        ensure!(
            load.mass_g.is_none() || down.is_some(),
            "loads[{i}].mass_g: a weight pulls along gravity, which is in the plane of a hanging sheet only: set \
             posture.kind = \"hanging\" with `down`, or give a force"
        );
        let support = scene.supports.iter().find(|support| support.panel == panel);
        let held = support.map_or([false; 3], |support| support.kind.holds());
        ensure!(
            std::iter::zip(held, load.values(down)).all(|(held, value)| !held || value == 0.0),
            "loads[{i}]: the support of panel {panel:?} prevents the motion of this load, which does no work: remove it"
        );
    }
    for (i, load) in scene.opening_couples.iter().enumerate() {
        let Some(panels) = load.panels else {
            continue;
        };
        for panel in panels {
            check_panel(topology, &format!("opening_couples[{i}].panels"), panel)?;
        }
        let [first, second] = panels;
        ensure!(
            first[0].abs_diff(second[0]) + first[1].abs_diff(second[1]) == 1,
            "opening_couples[{i}].panels = {panels:?} are not neighbours"
        );
    }
    Ok(())
}

/// A panel that a key names must be one of the sheet.
fn check_panel(topology: &Topology, key: &str, panel: [usize; 2]) -> Result<(), Fault> {
    ensure!(
        topology.panel(panel[0], panel[1]).is_some(),
        "{key} = {panel:?} violates column < {} and row < {} (panels are counted from [0, 0] at the lower left)",
        topology.grid.m,
        topology.grid.n
    );
    Ok(())
}
