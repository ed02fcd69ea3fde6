//! Another number of panels: what is held and pulled stays about where it was, and the sheet opens
//! as far as before.
//!
//! Even and odd panels turn in opposite senses. If a held panel became an odd one instead of an
//! even one, the sheet would open as the mirror image of the one before: the pulls and the target
//! would point elsewhere, and the stroke would tear it. So what is held or pulled moves to the
//! nearest panel that turns in the same sense. The stroke changes as the stroke of the sheet of
//! rigid panels does.

use anyhow::Result;
use app::new_project::first_scene::OPENING;
use design::sheet::ideal_deployment::opened_about;
use scene::{At, NamedPoint, Scene, SceneConfig, StartConfig, rounded};
use support::Extremes;

/// The scene of a uniform sheet with this number of columns and rows.
pub(crate) fn with_panels(scene: &Scene, panels: [usize; 2]) -> Result<Scene> {
    let mut config = scene.config.clone();
    config.sheet.panels = panels;
    config.start = StartConfig::default();
    let before = scene.config.sheet.panels;
    let supports = config.supports.iter_mut().map(|it| (it.at, &mut it.panel));
    let loads = config.loads.iter_mut().map(|it| (it.at, &mut it.panel));
    for (at, panel) in supports.chain(loads) {
        *panel = moved(*panel, at, before, panels);
    }
    // Changed before the stroke is: an error names the keys.
    let changed = scene.changed(config)?;
    let Some(mut drive) = changed.config.drive else {
        return Ok(changed);
    };
    if let Some((now, before)) = ideal_stroke(&changed)?.zip(ideal_stroke(scene)?)
        && (now / before).is_finite()
        && now / before > 0.0
    {
        drive.stroke = rounded(now / before * drive.stroke);
    }
    Ok(changed.changed(SceneConfig { drive: Some(drive), ..changed.config.clone() })?)
}

/// The panel, among those that turn in the same sense, that is nearest to where a panel was; at the
/// edge of the sheet if it was attached there.
fn moved(panel: [usize; 2], at: At, before: [usize; 2], after: [usize; 2]) -> [usize; 2] {
    let edge = match at {
        At::Named(NamedPoint::Left) if panel[0] == 0 => Some((0, 0)),
        At::Named(NamedPoint::Right) if panel[0] + 1 == before[0] => {
            Some((0, after[0].saturating_sub(1)))
        }
        At::Named(NamedPoint::Bottom) if panel[1] == 0 => Some((1, 0)),
        At::Named(NamedPoint::Top) if panel[1] + 1 == before[1] => {
            Some((1, after[1].saturating_sub(1)))
        }
        _ => None,
    };
    // Where its middle was, in columns and rows of now.
    let was: [f64; 2] = std::array::from_fn(|axis| {
        (panel[axis] as f64 + 0.5) * after[axis] as f64 / before[axis] as f64 - 0.5
    });
    let near = |axis: usize| match edge {
        Some((of, line)) if of == axis => line..(line + 1).min(after[axis]),
        _ => (was[axis] as usize).saturating_sub(1)..(was[axis] as usize + 3).min(after[axis]),
    };
    // In parts of the sheet.
    let distance = |to: &[usize; 2]| {
        let [x, y]: [f64; 2] =
            std::array::from_fn(|axis| (to[axis] as f64 - was[axis]) / after[axis] as f64);
        x.hypot(y)
    };
    let all = near(1).flat_map(|row| near(0).map(move |column| [column, row]));
    let alike = all.filter(|to| (to[0] + to[1]) % 2 == (panel[0] + panel[1]) % 2);
    let nearest = alike.smallest_by(distance);
    nearest.unwrap_or(panel)
}

/// The stroke at which the hinges of the sheet of rigid panels open by [`OPENING`], seen from the
/// first panel that is held; `None` without loads.
fn ideal_stroke(scene: &Scene) -> Result<Option<f64>> {
    let problem = scene.problem()?;
    let (_, sheet) = problem.cut(&scene.start())?;
    let supports = scene.actuation().supports;
    let held = supports.first().map_or(0, |support| support.panel);
    let motions = opened_about(&sheet, held, OPENING);
    let mechanics = problem.model.mechanics();
    Ok(mechanics.and_then(|it| it.solver.displacement(&motions)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// The load at the end of the path (N), of the scene with its columns and rows changed one
    /// after the other.
    #[test]
    fn a_sheet_with_other_panels_is_pulled_as_before() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let scene = Scene::read(&root.join("../configs/scenes/a4-plate.toml")).unwrap();
        let load = |scene: &Scene| {
            let deployment = scene.problem().unwrap().deploy(&scene.start()).unwrap();
            deployment.at_full_load().unwrap().load_factor
        };
        let before = load(&scene);
        for changes in [
            &[[4, 4], [5, 4], [4, 4], [3, 4]][..],
            &[[3, 5], [3, 6], [3, 5], [3, 4]],
            &[[5, 4], [5, 5]],
            &[[3, 3]],
        ] {
            let mut shown = scene.changed(scene.config.clone()).unwrap();
            for panels in changes {
                shown = with_panels(&shown, *panels).unwrap();
                let now = load(&shown);
                assert!(
                    now > 0.2 * before && now < 10.0 * before,
                    "{panels:?}: {now} N, not {before} N"
                );
            }
            if shown.config.sheet == scene.config.sheet {
                assert_eq!(shown.config.supports, scene.config.supports);
                assert_eq!(shown.config.loads, scene.config.loads);
                let strokes = [&shown, &scene].map(|scene| scene.config.drive.unwrap().stroke);
                assert!((strokes[0] - strokes[1]).abs() < 1e-3, "{strokes:?}");
            }
        }
    }

    #[test]
    fn what_is_held_stays_at_its_edge_and_turns_in_the_same_sense() {
        let at = |point| At::Named(point);
        for after in [[2, 2], [3, 5], [4, 4], [8, 3], [7, 7]] {
            for (panel, point) in [
                ([1, 3], NamedPoint::Top),
                ([0, 2], NamedPoint::Left),
                ([2, 1], NamedPoint::Right),
                ([2, 0], NamedPoint::Bottom),
                ([1, 1], NamedPoint::Centroid),
            ] {
                let [column, row] = moved(panel, at(point), [3, 4], after);
                assert_eq!((column + row) % 2, (panel[0] + panel[1]) % 2);
                assert!(column < after[0] && row < after[1]);
                let is_there = match point {
                    NamedPoint::Top => row + 1 == after[1],
                    NamedPoint::Right => column + 1 == after[0],
                    NamedPoint::Left => column == 0,
                    NamedPoint::Bottom => row == 0,
                    NamedPoint::Centroid => true,
                };
                assert!(is_there, "{panel:?} to [{column}, {row}] of {after:?}");
            }
        }
        // What the sheet cannot have is refused with the other keys.
        assert_eq!(moved([1, 3], at(NamedPoint::Top), [3, 4], [0, 0]), [1, 3]);
    }
}
