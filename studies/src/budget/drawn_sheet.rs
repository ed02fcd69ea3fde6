//! Small sheets with drawn panels, ligaments, supports and loads, for which finite elements of every hinge are affordable.

use anyhow::{Context, Result};
use design::equilibrium::load_step::{LoadStep, Status};
use design::scene::{
    At, DriveConfig, LoadConfig, NamedPoint, Scene, SceneConfig, SupportConfig, SupportKind,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::path::Path;

/// Every so many sheets one has six panels and seven hinges; the others have four of both.
const LARGER: u64 = 8;
/// Sides of a panel (mm) and mean ligament width over the thickness.
const PANEL: [f64; 2] = [70.0, 110.0];
const LIGAMENT: [f64; 2] = [22.0, 42.0];
/// Stroke over the diagonal of the sheet, and maximum angle between the pull and the line to the held panel (rad).
const STROKE: [f64; 2] = [0.05, 0.18];
const OBLIQUE: f64 = 0.5;
/// Root mean square rotation of the hinges of a sheet that is judged (rad).
const OPENING: [f64; 2] = [0.15, 0.6];
/// Maximum number of draws until a sheet opens on a smooth path inside the training domain.
const DRAWS: usize = 1000;

/// The sheet of a number: the scene `base` at `path`, drawn again until it opens on a smooth and stable path inside the training
/// domain. Half of the sheets have a prescribed stroke, the others dead loads of the size that the stroke takes.
pub(super) fn drawn_sheet(base: &SceneConfig, path: &Path, number: u64) -> Result<Scene> {
    let mut random = ChaCha8Rng::seed_from_u64(number);
    for _ in 0..DRAWS {
        let mut config = drawn(base, number, &mut random);
        let scene = Scene::new(config.clone(), path)?;
        let Some(driven) = opened(&scene)? else {
            continue;
        };
        if number.is_multiple_of(2) {
            return Ok(scene);
        }
        config.drive = None;
        config.scale_loads(driven.load_factor);
        let scene = Scene::new(config, path)?;
        if opened(&scene)?.is_some() {
            return Ok(scene);
        }
    }
    Err(anyhow::anyhow!("none of {DRAWS} sheets opens")).context(format!("sheet {number}"))
}

fn drawn(base: &SceneConfig, number: u64, random: &mut ChaCha8Rng) -> SceneConfig {
    let mut config = base.clone();
    let [columns, rows] = match number % LARGER {
        0..7 => [2, 2],
        _ if random.random_bool(0.5) => [2, 3],
        _ => [3, 2],
    };
    let mut between = |[low, high]: [f64; 2]| random.random_range(low..high);
    let size = [columns, rows].map(|count: usize| count as f64 * between(PANEL));
    let thickness = base.thickness.unwrap_or(1.0);
    config.ligament.start = thickness * between(LIGAMENT);
    let stroke = size[0].hypot(size[1]) * between(STROKE);
    let oblique = between([-OBLIQUE, OBLIQUE]);
    let held = [0, rows - 1];
    let clamped = random.random_bool(0.5);
    let pulled = [columns - 1, random.random_range(0..rows)];
    let [x, y] = [
        size[0] / columns as f64 * (columns - 1) as f64,
        size[1] / rows as f64 * (pulled[1] as f64 - held[1] as f64),
    ];
    let (sin, cos) = (y.atan2(x) + oblique).sin_cos();
    let hold = |panel, kind| SupportConfig {
        panel,
        kind,
        ..base.supports[0]
    };
    config.title = format!("Sheet {number}");
    config.sheet.size = Some(size);
    config.sheet.panels = [columns, rows];
    config.supports = if clamped {
        vec![hold(held, SupportKind::Clamp)]
    } else {
        vec![
            hold(held, SupportKind::Pin),
            hold([0, 0], SupportKind::RollerY),
        ]
    };
    config.loads = vec![LoadConfig {
        panel: pulled,
        at: At::Named(if random.random_bool(0.5) {
            NamedPoint::Centroid
        } else {
            NamedPoint::Right
        }),
        force: [cos, sin],
        ..base.loads[0]
    }];
    config.drive = Some(DriveConfig { stroke });
    config.optimiser.seed = random.random();
    config
}

/// The last state of a scene's start design; `None` if its path is not smooth and stable, leaves the training domain or ends
/// outside of [`OPENING`].
fn opened(scene: &Scene) -> Result<Option<LoadStep>> {
    let Ok(mut deployment) = scene.problem()?.deploy(&scene.start()) else {
        return Ok(None);
    };
    let smooth = (deployment.path.iter()).all(|step| step.status == Status::Converged);
    let [least, most] = OPENING;
    let last = deployment.path.pop();
    Ok(last.filter(|last| smooth && (least..=most).contains(&last.opening())))
}
