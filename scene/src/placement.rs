//! The deployed sheet in the position in which the objective compares it with the target.

use crate::checked_scene::Scene;
use design::{
    geometry::region,
    objective::{centre, design_problem::Deployment},
    sheet::{
        cut_sheet::Sheet,
        kinematics::{Configuration, deployed, deployed_boundaries},
        topology::PanelCorner,
    },
};
use support::Point;

/// How much of a target is seen at least if a viewer recognises it.
pub const RECOGNISED: f64 = 0.9;
/// How much of a target is seen at least if a viewer may recognise it.
pub const NOT_SEEN: f64 = 0.75;

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

/// What one sees of the opened panels, gaps closed, in the position in which the objective compares
/// it: the area in common with the target over the area of both.
pub fn seen(scene: &Scene, deployment: &Deployment) -> f64 {
    seen_in(scene, deployment, &deployment.final_step().configuration)
}

/// What one sees of the panels of a deployment in another configuration.
pub fn seen_in(scene: &Scene, deployment: &Deployment, configuration: &[[f64; 3]]) -> f64 {
    let sheet = &deployment.sheet;
    let configuration = placed(scene, sheet, configuration);
    let target = scene.target.region();
    region::seen(deployed_boundaries(sheet, &configuration), &target)
}

fn corners(sheet: &Sheet, corners: Vec<PanelCorner>, configuration: &[[f64; 3]]) -> Vec<Point> {
    corners
        .into_iter()
        .map(|(k, corner)| {
            let panel = &sheet.panels[k];
            deployed(panel, configuration[k], panel.boundary[corner])
        })
        .collect()
}
