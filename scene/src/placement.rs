//! The deployed sheet in the position in which the objective compares it with the target.

use crate::checked_scene::Scene;
use design::objective::centre;
use design::objective::design_problem::Deployment;
use design::sheet::cut_sheet::Sheet;
use design::sheet::kinematics::{Configuration, deployed};
use design::sheet::topology::PanelCorner;

/// The configuration in the position in which the objective compares it with the target: the centre
/// of a sheet without supports lies at the centre of the target.
pub fn placed(scene: &Scene, sheet: &Sheet, configuration: &[[f64; 3]]) -> Configuration {
    let mut placed = configuration.to_vec();
    if scene.config.supports.is_empty() {
        let outline = corners(sheet, sheet.free_outline_corners(), configuration);
        let [from, to] = [&outline, &scene.target.points].map(|it| centre::of(it));
        for axis in 0..2 {
            let shift = to[axis] - from[axis];
            placed.iter_mut().for_each(|motion| motion[axis] += shift);
        }
    }
    placed
}

/// The deployed outline through all of its corners, in the position in which the objective compares
/// it (mm).
pub fn deployed_outline(scene: &Scene, deployment: &Deployment) -> Vec<[f64; 2]> {
    let sheet = &deployment.sheet;
    let configuration = placed(scene, sheet, &deployment.final_step().configuration);
    corners(sheet, sheet.outline_corners(), &configuration)
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
