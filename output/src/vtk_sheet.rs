//! The deployment of a sheet as VTK grids: panels as quadrilaterals and hinges as points, one pair of grids a state.
//!
//! Points are those of the flat sheet; the point data `displacement (mm)` moves them to the deployed one.

use crate::hinge_states::{HingeState, hinge_states};
use design::equilibrium::load_step::LoadStep;
use design::objective::design_problem::Deployment;
use design::sheet::cut_sheet::Sheet;
use design::sheet::kinematics::{deployed, deployed_corners};
use support::vtk::{CellKind, Field, UnstructuredGrid};

/// A state of the deployment.
#[derive(Clone, Debug)]
pub struct VtkState {
    /// zeta; while the weight comes on, the part of it that is on, less one.
    pub time: f64,
    /// Four points and one cell for each panel; cell data: number and rotation.
    pub panels: UnstructuredGrid,
    /// One point and one cell for each hinge, at its reference point; point data: number, (8), energy, damage.
    pub hinges: UnstructuredGrid,
}

/// The flat sheet and every load step.
pub fn vtk_states(deployment: &Deployment) -> Vec<VtkState> {
    let sheet = &deployment.sheet;
    let states = hinge_states(deployment);
    let flat: Vec<HingeState> = states[..sheet.hinges.len()].iter().map(flat).collect();
    let still = vec![[0.0; 3]; sheet.panels.len()];
    let steps = deployment
        .path
        .iter()
        .map(|step| (time(step), &step.configuration));
    let hinges = std::iter::once(&flat[..]).chain(states.chunks(sheet.hinges.len()));
    let start = if deployment.weight_steps().is_empty() {
        0.0
    } else {
        -1.0
    };
    std::iter::once((start, &still))
        .chain(steps)
        .zip(hinges)
        .map(|((time, configuration), states)| VtkState {
            time,
            panels: panels(sheet, configuration),
            hinges: hinge_points(sheet, configuration, states),
        })
        .collect()
}

/// The time of a load step in an animation.
fn time(step: &LoadStep) -> f64 {
    if step.weight < 1.0 {
        step.weight - 1.0
    } else {
        step.load_factor
    }
}

fn flat(state: &HingeState) -> HingeState {
    HingeState {
        step: 0,
        load_factor: 0.0,
        deformation: [0.0; 3],
        eta: [0.0; 2],
        energy: 0.0,
        damage: state.damage.map(|damage| damage.map(|_| 0.0)),
        inside: true,
        ..*state
    }
}

fn panels(sheet: &Sheet, configuration: &[[f64; 3]]) -> UnstructuredGrid {
    let points = sheet.panels.iter().flat_map(|panel| panel.corners);
    let moved = deployed_corners(sheet, configuration);
    let displacements = std::iter::zip(points.clone(), moved.into_iter().flatten());
    UnstructuredGrid {
        kind: CellKind::Quad,
        cells: (0..sheet.panels.len())
            .map(|k| (4 * k..4 * k + 4).collect())
            .collect(),
        point_data: vec![displacement(displacements)],
        cell_data: vec![
            Field::scalar("panel", (0..sheet.panels.len()).map(|k| k as f64)),
            Field::scalar(
                "rotation (deg)",
                configuration.iter().map(|motion| motion[2].to_degrees()),
            ),
        ],
        points: points.map(spatial).collect(),
    }
}

fn hinge_points(
    sheet: &Sheet,
    configuration: &[[f64; 3]],
    states: &[HingeState],
) -> UnstructuredGrid {
    // The reference point moves with both panels, which part by (a, s): their mean is drawn.
    let moved = sheet.hinges.iter().map(|hinge| {
        let [a, b] = [hinge.panel_a(), hinge.panel_b()]
            .map(|k| deployed(&sheet.panels[k], configuration[k], hinge.attachment));
        (
            hinge.attachment,
            [0, 1].map(|axis| 0.5 * (a[axis] + b[axis])),
        )
    });
    let of = |name, value: fn(&HingeState) -> f64| Field::scalar(name, states.iter().map(value));
    UnstructuredGrid {
        points: sheet
            .hinges
            .iter()
            .map(|hinge| spatial(hinge.attachment))
            .collect(),
        kind: CellKind::Vertex,
        cells: (0..sheet.hinges.len()).map(|h| vec![h]).collect(),
        point_data: vec![
            displacement(moved),
            of("hinge", |state| state.hinge as f64),
            of("w_lig (mm)", |state| state.w_lig),
            of("a (mm)", |state| state.deformation[0]),
            of("s (mm)", |state| state.deformation[1]),
            of("theta (deg)", |state| state.deformation[2].to_degrees()),
            of("W (N mm)", |state| state.energy),
            of("D", |state| state.damage[0].unwrap_or(f64::NAN)),
            of("D_peak", |state| state.damage[1].unwrap_or(f64::NAN)),
            of("inside", |state| f64::from(u8::from(state.inside))),
        ],
        cell_data: Vec::new(),
    }
}

/// From the flat to the deployed positions.
fn displacement(moved: impl Iterator<Item = ([f64; 2], [f64; 2])>) -> Field {
    let vectors = moved.map(|(from, to)| [to[0] - from[0], to[1] - from[1], 0.0]);
    Field::vector("displacement (mm)", vectors)
}

fn spatial([x, y]: [f64; 2]) -> [f64; 3] {
    [x, y, 0.0]
}
