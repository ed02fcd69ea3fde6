//! The drives of Table 1 in several readings of section 3.2: the minimum loads with which the uniform sheet, from which the
//! designs start, matches the target.

use anyhow::{Context, Result};
use design::analysis::threshold::least_passing;
use design::objective::scores::outline_error;
use design::objective::target::TargetShape;
use design::scene::{Scene, SceneConfig};
use std::path::Path;

/// The sheet matches its target if its outline error (root mean square), relative to the target's width, is at
/// most this: the error of the paper's designs.
const REACHED: f64 = 0.012;
/// Relative accuracy of the minimum load.
const RESOLUTION: f64 = 0.005;
/// Stretch of the target of the scenes, as the paper states it, and of the ideal deployment at 70 degrees (6).
const STRETCHES: [f64; 2] = [1.40, 1.3927];
/// Couple over force in case III of the scenes, and that with which the couple does 60 % of the work (mm).
const LEVERS: [f64; 2] = [1048.0, 2743.0];

/// One reading.
pub struct Reading {
    pub name: &'static str,
    change: fn(&mut SceneConfig),
}

/// The first is that of the scenes.
pub const READINGS: [Reading; 3] = [
    Reading {
        name: "target 1.40 times the sheet; couple with 60 % of the generalised force",
        change: |_| (),
    },
    Reading {
        name: "target 1.393 times the sheet",
        change: ideal_target,
    },
    Reading {
        name: "couple with 60 % of the work",
        change: |config| {
            for load in &mut config.loads {
                load.couple *= LEVERS[1] / LEVERS[0];
            }
        },
    },
];

impl Reading {
    /// The minimum factor on the loads of a scene for which the uniform sheet matches the target.
    pub fn least_factor(&self, config: &SceneConfig, path: &Path) -> Result<f64> {
        let mut config = config.clone();
        (self.change)(&mut config);
        let factor = least_passing(1.0, RESOLUTION, |factor| {
            let mut config = config.clone();
            config.scale_loads(factor);
            let scene = Scene::new(config, path)?;
            let problem = scene.problem()?;
            let error = outline_error(&problem.objective, &problem.deploy(&scene.start())?);
            Ok::<_, anyhow::Error>(error <= REACHED * scene.target.width())
        })?;
        factor.with_context(|| {
            format!(
                "{}: no load factor found for which the uniform sheet matches the target",
                path.display()
            )
        })
    }
}

/// Shrinks the target about the centroid of the panel at the lower left corner, which is pinned.
fn ideal_target(config: &mut SceneConfig) {
    let ratio = STRETCHES[1] / STRETCHES[0];
    let [columns, rows] = config.sheet.panels.map(|count| count as f64);
    let [width, height] = config.sheet.size.unwrap_or_default();
    let pinned = [0.5 * width / columns, 0.5 * height / rows];
    if let TargetShape::Rectangle { centre, size, .. } = &mut config.target {
        *size = size.map(|side| ratio * side);
        for axis in 0..2 {
            centre[axis] = pinned[axis] + ratio * (centre[axis] - pinned[axis]);
        }
    }
}
