//! How far the deployed outline lies from the target, as people state it: a root mean square length.

use crate::chamfer::{Chamfer, Precision};
use crate::gradient::Deployment;
use crate::kinematics::{Configuration, deployed};
use crate::objective::OutlinePoints;
use crate::scene::Scene;
use crate::sheet::Sheet;
use crate::topology::PanelCorner;

/// Root mean square distance of the deployed outline points P to the curve through the target's
/// samples (mm).
///
/// It is the root of the first sum of the Chamfer distance to the curve. The second, coverage, also counts how far
/// apart the points of P are, so that it stays large on a coarse sheet that meets its target.
pub fn outline_error(scene: &Scene, deployment: &Deployment) -> f64 {
    let outline = deployed_outline(scene, deployment, scene.config.objective.outline);
    let precision = Chamfer {
        coverage_weight: 0.0,
        smoothing: 0.0,
        precision: Precision::Curve,
    };
    let (squared, _) = precision.evaluate(&outline, scene.target.points());
    squared.sqrt()
}

/// The configuration where the objective compares it with the target: a sheet that is held nowhere
/// is centred on it.
pub(crate) fn placed(scene: &Scene, sheet: &Sheet, configuration: &[[f64; 3]]) -> Configuration {
    let mut placed = configuration.to_vec();
    if scene.config.supports.is_empty() {
        let points = scene.config.objective.outline.of(sheet);
        let points = corners(sheet, points, configuration);
        for axis in 0..2 {
            let sum: f64 = points.iter().map(|point| point[axis]).sum();
            let shift = scene.target.mean()[axis] - sum / points.len() as f64;
            placed.iter_mut().for_each(|motion| motion[axis] += shift);
        }
    }
    placed
}

/// The deployed outline through `points`, where the objective compares it (mm).
pub fn deployed_outline(
    scene: &Scene,
    deployment: &Deployment,
    points: OutlinePoints,
) -> Vec<[f64; 2]> {
    let sheet = &deployment.sheet;
    let configuration = placed(scene, sheet, &deployment.final_step().configuration);
    corners(sheet, points.of(sheet), &configuration)
}

fn corners(sheet: &Sheet, corners: Vec<PanelCorner>, configuration: &[[f64; 3]]) -> Vec<[f64; 2]> {
    corners
        .into_iter()
        .map(|(k, corner)| {
            let panel = &sheet.panels[k];
            deployed(panel, configuration[k], panel.corners[corner])
        })
        .collect()
}
