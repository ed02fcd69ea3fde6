//! The deployed sheet in the position in which the objective compares it with the target.

use crate::checked_scene::Scene;
use design::{
    geometry::{
        plane::{complex, point},
        region,
    },
    objective::{centre, design_problem::Deployment, shape},
    sheet::{
        cut_sheet::Sheet,
        kinematics::{Configuration, deployed, deployed_boundaries},
        topology::PanelCorner,
    },
};

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
    // A target that is fitted to the sheet is as large as the sheet.
    let turn = shape::turn(deployment.fit);
    let centre = complex(centre::of(&scene.target.points));
    let placed = |at: &[f64; 2]| point(centre + turn * (complex(*at) - centre));
    let panels = deployed_boundaries(sheet, &configuration);
    let panels = panels.iter().map(|panel| panel.iter().map(placed).collect()).collect();
    region::seen(panels, &target)
}

fn corners(sheet: &Sheet, corners: Vec<PanelCorner>, configuration: &[[f64; 3]]) -> Vec<[f64; 2]> {
    corners
        .into_iter()
        .map(|(k, corner)| {
            let panel = &sheet.panels[k];
            deployed(panel, configuration[k], panel.boundary[corner])
        })
        .collect()
}
