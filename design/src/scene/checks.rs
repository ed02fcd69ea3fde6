//! Admissible ranges of the values of a scene.
//!
//! The ranges are wider than those of any real sheet, and narrower than an error by a factor of 1000.

use crate::geometry::polygon::edges;
use crate::objective::target::Target;
use crate::pattern::cut_pattern::Outline;
use crate::pattern::pattern_error::PatternError;
use crate::scene::hinge_model::HingeModel;
use crate::scene::keys::SceneConfig;
use crate::scene::sheet_config::SheetConfig;
use hinge::HingeDesign;
use std::f64::consts::FRAC_PI_2;

/// Checks everything that needs no other file. The error states the key, the limit and, if a
/// factor of 1000 would correct the value, the probable unit.
pub(super) fn config(scene: &SceneConfig) -> Result<(), String> {
    title(scene)?;
    sheet(scene)?;
    ligament(scene)?;
    within(
        "cutting.over_run",
        scene.cutting.over_run,
        [0.0, 50.0],
        "mm",
    )?;
    start(scene)?;
    supports(scene)?;
    loads(scene)?;
    search(scene)
}

/// Maximum ratio of the target's perimeter to that of the flat sheet. Panels keep their edges: a sheet of squares
/// opens to twice its width; a sheet of slender panels opens further, but along one axis only.
const OPENS_TO: f64 = 3.0;

/// Maximum distance between the middles of target and flat sheet (mm): supports move a sheet by 100 m at most.
const AWAY: f64 = 1e6;

/// A target of a very different size than the sheet, or far away from it, is assumed to be in the wrong unit.
pub(super) fn target(target: &Target, outline: &Outline) -> Result<(), String> {
    let perimeter: f64 = edges(&outline.corners)
        .map(|(p, q)| f64::hypot(q[0] - p[0], q[1] - p[1]))
        .sum();
    within(
        "length of the target outline",
        target.length(),
        [0.2 * perimeter, OPENS_TO * perimeter],
        "mm",
    )
    .map_err(|error| {
        format!("{error} (the outline of the flat sheet is {perimeter:.0} mm long)")
    })?;
    let middle = |axis: usize| {
        outline
            .corners
            .iter()
            .map(|corner| 0.25 * corner[axis])
            .sum::<f64>()
    };
    let [x, y] = target.mean();
    let away = f64::hypot(x - middle(0), y - middle(1));
    within(
        "distance of the target from the sheet",
        away,
        [0.0, AWAY],
        "mm",
    )
}

/// The title is written to SVG pictures, which must not contain control characters.
fn title(scene: &SceneConfig) -> Result<(), String> {
    match scene.title.chars().find(|c| c.is_control()) {
        Some(c) => Err(format!(
            "title contains the control character {c:?}: remove it"
        )),
        None => Ok(()),
    }
}

fn sheet(scene: &SceneConfig) -> Result<(), String> {
    let SheetConfig { size, corners, .. } = scene.sheet;
    if size.is_some() == corners.is_some() {
        return Err("sheet: give either size or corners".into());
    }
    for side in size.into_iter().flatten() {
        within("sheet.size", side, [20.0, 2e4], "mm")?;
    }
    let outline = scene.sheet.outline();
    if !outline.is_convex() {
        let corners = outline.corners;
        return Err(format!(
            "sheet.corners: {}",
            PatternError::Outline { corners }
        ));
    }
    within(
        "the size of sheet.corners",
        outline.size(),
        [20.0, 2e4],
        "mm",
    )?;
    let [columns, rows] = scene.sheet.panels;
    if columns < 2 || rows < 2 || columns.saturating_mul(rows) > 100_000 {
        return Err(format!(
            "sheet.panels = [{columns}, {rows}] violates 2 <= columns, 2 <= rows and \
             columns * rows <= 100000"
        ));
    }
    Ok(())
}

fn ligament(scene: &SceneConfig) -> Result<(), String> {
    let (ligament, process) = (&scene.ligament, &scene.process);
    let [min, max] = ligament.range;
    for w_lig in [min, max] {
        let design = HingeDesign {
            w_lig,
            alpha: FRAC_PI_2,
            fillet_ratio: process.fillet_ratio,
            kerf: process.kerf,
            r_win: process.r_win,
        };
        design.validate().map_err(|error| {
            format!("ligament.range and process, at w_lig = {w_lig} mm: {error}")
        })?;
    }
    let largest = scene.sheet.outline().size();
    let r_win = process.r_win;
    within("process.r_win", r_win, [0.0, 10.0 * largest], "mm").map_err(|error| {
        format!("{error} (a window is a part of the sheet, which is {largest:.0} mm large)")
    })?;
    if min >= max {
        return Err(format!(
            "ligament.range = [{min}, {max}] mm violates minimum < maximum"
        ));
    }
    if !(ligament.start > min && ligament.start < max) {
        return Err(format!(
            "ligament.start = {} mm violates {min} < start < {max} mm (ligament.range)",
            ligament.start
        ));
    }
    // A slit is at most as long as two panels and is shortened at each end by a ligament and its hole.
    let outline = scene.sheet.outline();
    let panel = (outline.area() / scene.sheet.grid().panel_count() as f64).sqrt();
    let taken = (1.0 + process.fillet_ratio) * min;
    if taken >= panel {
        return Err(format!(
            "ligament.range: ligaments of {min} mm with their holes take {taken:.1} mm, but panels are \
             {panel:.1} mm wide on average, so no slit is left: narrow the ligaments or use fewer panels"
        ));
    }
    Ok(())
}

fn start(scene: &SceneConfig) -> Result<(), String> {
    let start = &scene.start;
    for (explicit, logits, twice) in [
        ("r", "z", start.r.is_some() && start.z.is_some()),
        ("tau", "ell", start.tau.is_some() && start.ell.is_some()),
    ] {
        if twice {
            return Err(format!("start: give either {explicit} or {logits}"));
        }
    }
    let grid = scene.sheet.grid();
    start
        .pattern(grid)
        .map_err(|error| format!("start: {error}"))?;
    let Some(w_lig) = &start.w_lig else {
        return Ok(());
    };
    if w_lig.len() != grid.hinge_count() {
        return Err(format!(
            "start.w_lig has {} entries; the sheet has {} hinges",
            w_lig.len(),
            grid.hinge_count()
        ));
    }
    let [min, max] = scene.ligament.range;
    match w_lig.iter().find(|w| !(**w > min && **w < max)) {
        Some(w) => Err(format!(
            "start.w_lig = {w} mm violates {min} < w_lig < {max} mm (ligament.range)"
        )),
        None => Ok(()),
    }
}

fn supports(scene: &SceneConfig) -> Result<(), String> {
    if scene.supports.is_empty() && scene.hinge != HingeModel::Pin {
        return Err(
            "supports: a sheet without supports has no equilibrium: add [[supports]]".into(),
        );
    }
    for (i, support) in scene.supports.iter().enumerate() {
        panel(scene, &format!("supports[{i}]"), support.panel)?;
        if scene.supports[..i]
            .iter()
            .any(|other| other.panel == support.panel)
        {
            return Err(format!(
                "supports[{i}].panel = {:?} is supported twice",
                support.panel
            ));
        }
        let key = format!("supports[{i}]");
        for displacement in support.displacement {
            within(
                &format!("{key}.displacement"),
                displacement,
                [-1e5, 1e5],
                "mm",
            )?;
        }
        within(
            &format!("{key}.rotation_deg"),
            support.rotation_deg,
            [-720.0, 720.0],
            "deg",
        )?;
        let mut motions = support.motion().into_iter().zip(support.kind.holds());
        if motions.any(|(motion, held)| motion != 0.0 && !held) {
            return Err(format!(
                "{key} prescribes a motion that a support of its kind leaves free: change kind, \
                 displacement or rotation_deg"
            ));
        }
    }
    Ok(())
}

fn loads(scene: &SceneConfig) -> Result<(), String> {
    for (i, load) in scene.loads.iter().enumerate() {
        let key = format!("loads[{i}]");
        panel(scene, &key, load.panel)?;
        for force in load.force {
            within(&format!("{key}.force"), force, [-1e5, 1e5], "N")?;
        }
        within(&format!("{key}.couple"), load.couple, [-1e8, 1e8], "N mm")?;
        let support = scene
            .supports
            .iter()
            .find(|support| support.panel == load.panel);
        let values = [load.force[0], load.force[1], load.couple];
        let held = support.map_or([false; 3], |support| support.kind.holds());
        if held
            .iter()
            .zip(values)
            .any(|(held, value)| *held && value != 0.0)
        {
            return Err(format!(
                "{key}: the support of panel {:?} prevents the motion of this load, which does no work: remove it",
                load.panel
            ));
        }
    }
    for (i, load) in scene.edge_loads.iter().enumerate() {
        for traction in load.traction {
            within(
                &format!("edge_loads[{i}].traction"),
                traction,
                [-1e3, 1e3],
                "N/mm",
            )?;
        }
    }
    for (i, load) in scene.opening_couples.iter().enumerate() {
        let key = format!("opening_couples[{i}]");
        within(&format!("{key}.couple"), load.couple, [-1e8, 1e8], "N mm")?;
        let Some([first, second]) = load.panels else {
            continue;
        };
        panel(scene, &key, first)?;
        panel(scene, &key, second)?;
        if first[0].abs_diff(second[0]) + first[1].abs_diff(second[1]) != 1 {
            return Err(format!(
                "{key}.panels = [{first:?}, {second:?}] are not neighbours"
            ));
        }
    }
    match scene.drive {
        Some(drive) => within("drive.stroke", drive.stroke, [-1e5, 1e5], "mm"),
        None => Ok(()),
    }
}

fn search(scene: &SceneConfig) -> Result<(), String> {
    counted("load_steps", scene.load_steps, 10_000)?;
    let objective = &scene.objective;
    counted(
        "objective.target_points",
        objective.target_points,
        1_000_000,
    )?;
    for (key, weight) in [
        ("objective.coverage", objective.coverage),
        ("objective.damage", objective.damage),
        ("objective.compression", objective.compression),
        ("objective.shear", objective.shear),
        ("objective.panel_shape", objective.panel_shape),
        ("objective.domain", objective.domain),
        ("objective.smoothing", objective.smoothing),
    ] {
        within(key, weight, [0.0, 1e9], "")?;
    }
    let [columns, rows] = scene.sheet.panels;
    let square = (scene.sheet.outline().area() / (columns * rows) as f64).sqrt();
    within(
        "objective.min_panel_width",
        objective.min_panel_width,
        [0.0, square / 3.0],
        "mm",
    )?;
    let solver = &scene.solver;
    within("solver.tolerance", solver.tolerance, [1e-14, 0.1], "")?;
    counted("solver.follow_every", solver.follow_every, 10_000)?;
    let optimiser = &scene.optimiser;
    counted("optimiser.steps", optimiser.steps, 10_000_000)?;
    within(
        "optimiser.learning_rate",
        optimiser.learning_rate,
        [1e-9, 10.0],
        "",
    )?;
    within(
        "optimiser.start_noise",
        optimiser.start_noise,
        [0.0, 10.0],
        "",
    )
}

fn panel(scene: &SceneConfig, key: &str, [column, row]: [usize; 2]) -> Result<(), String> {
    let [columns, rows] = scene.sheet.panels;
    if column < columns && row < rows {
        return Ok(());
    }
    Err(format!(
        "{key}.panel = [{column}, {row}] violates column < {columns} and row < {rows} \
         (panels are counted from [0, 0] at the lower left)"
    ))
}

fn counted(key: &str, value: usize, maximum: usize) -> Result<(), String> {
    if (1..=maximum).contains(&value) {
        return Ok(());
    }
    Err(format!("{key} = {value} violates 1 <= {key} <= {maximum}"))
}

pub(super) fn within(
    key: &str,
    value: f64,
    [min, max]: [f64; 2],
    unit: &str,
) -> Result<(), String> {
    let range = min..=max;
    if range.contains(&value) {
        return Ok(());
    }
    let slip = [1e3, 1e-3].map(|factor| without_rounding(factor * value));
    let hint = slip
        .iter()
        .find(|meant| !unit.is_empty() && range.contains(meant))
        .map(|meant| format!("; did you mean {meant} {unit}?"))
        .unwrap_or_default();
    let [min, max] = [min, max].map(without_rounding);
    Err(format!(
        "{key} = {value} {unit} violates {min} <= {key} <= {max} {unit}{hint}"
    ))
}

/// The number with nine significant digits, so that a product is shown without its rounding error.
fn without_rounding(value: f64) -> f64 {
    let digits = format!("{value:.8e}");
    digits.parse().unwrap_or(value)
}
