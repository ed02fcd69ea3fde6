//! The deployment of a sheet as VTK grids: panels as quadrilaterals and hinges as points, one pair
//! of grids a state.
//!
//! Points are the points of the flat sheet; the point data `displacement (mm)` moves them to the
//! deployed sheet.

use design::{
    equilibrium::load_step::LoadStep,
    hinge_law::DamageMeasure,
    objective::design_problem::Deployment,
    sheet::{
        cut_sheet::{Panel, Sheet},
        kinematics::{deployed, deployed_boundaries},
    },
};
use support::{
    Point,
    vtk::{CellKind, Field, UnstructuredGrid},
};

/// A state of the deployment.
#[derive(Clone, Debug)]
pub struct VtkState {
    /// zeta; while the weight comes on, the part of it that is on, less one.
    pub time: f64,
    /// Four points and one cell for each panel; cell data: number and rotation.
    pub panels: UnstructuredGrid,
    /// One point and one cell for each hinge, at its reference point; point data: number, (8),
    /// energy, damage.
    pub hinges: UnstructuredGrid,
}

/// The flat sheet and every load step.
pub fn vtk_states(deployment: &Deployment) -> Vec<VtkState> {
    let Deployment { sheet, path, .. } = deployment;
    let start = match deployment.weight_steps() {
        [] => 0.0,
        _ => -1.0,
    };
    let flat = vec![[0.0; 3]; sheet.panels.len()];
    let flat = VtkState {
        time: start,
        panels: panels(sheet, &flat),
        hinges: hinge_points(sheet, &flat, &path[0], true),
    };
    let states = path.iter().map(|step| VtkState {
        time: time(step),
        panels: panels(sheet, &step.configuration),
        hinges: hinge_points(sheet, &step.configuration, step, false),
    });
    std::iter::once(flat).chain(states).collect()
}

/// The time of a load step in an animation.
fn time(step: &LoadStep) -> f64 {
    if step.weight < 1.0 { step.weight - 1.0 } else { step.load_factor }
}

fn panels(sheet: &Sheet, configuration: &[[f64; 3]]) -> UnstructuredGrid {
    let points = sheet.panels.iter().flat_map(|panel| panel.boundary.iter().copied());
    let moved = deployed_boundaries(sheet, configuration);
    let displacements = std::iter::zip(points.clone(), moved.into_iter().flatten());
    let mut next = 0..;
    let cell = |panel: &Panel| next.by_ref().take(panel.boundary.len()).collect();
    UnstructuredGrid {
        kind: CellKind::Polygon,
        cells: sheet.panels.iter().map(cell).collect(),
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

/// The hinges in a load step; the `flat` ones have neither deformation nor damage.
fn hinge_points(
    sheet: &Sheet,
    configuration: &[[f64; 3]],
    step: &LoadStep,
    flat: bool,
) -> UnstructuredGrid {
    // The reference point moves with both panels, which part by (a, s): their mean is drawn.
    let moved = sheet.hinges.iter().map(|hinge| {
        let [a, b] =
            hinge.panels().map(|k| deployed(&sheet.panels[k], configuration[k], hinge.attachment));
        (hinge.attachment, [0, 1].map(|axis| 0.5 * (a[axis] + b[axis])))
    });
    let of = |name, value: &dyn Fn(usize) -> f64| {
        let shown = |x: f64| if flat && !x.is_nan() { 0.0 } else { x };
        Field::scalar(name, (0..sheet.hinges.len()).map(|h| shown(value(h))))
    };
    let damage = |name, measure: DamageMeasure| {
        let known = |h: usize| measure.known(step.damage.get(h)?).filter(|_| step.inside[h]);
        of(name, &|h| known(h).unwrap_or(f64::NAN))
    };
    let inside = |h: &bool| f64::from(u8::from(flat || *h));
    UnstructuredGrid {
        points: sheet.hinges.iter().map(|hinge| spatial(hinge.attachment)).collect(),
        kind: CellKind::Vertex,
        cells: (0..sheet.hinges.len()).map(|h| vec![h]).collect(),
        point_data: vec![
            displacement(moved),
            Field::scalar("hinge", (0..sheet.hinges.len()).map(|h| h as f64)),
            Field::scalar("w_lig (mm)", sheet.hinges.iter().map(|hinge| hinge.w_lig)),
            of("a (mm)", &|h| step.deformations[h].a),
            of("s (mm)", &|h| step.deformations[h].s),
            of("theta (deg)", &|h| step.deformations[h].theta.to_degrees()),
            of("W (N mm)", &|h| step.energies[h]),
            damage("D", DamageMeasure::Mean),
            damage("D_peak", DamageMeasure::Peak),
            Field::scalar("inside", step.inside.iter().map(inside)),
        ],
        cell_data: Vec::new(),
    }
}

/// From the flat to the deployed positions.
fn displacement(moved: impl Iterator<Item = (Point, Point)>) -> Field {
    let vectors = moved.map(|(from, to)| [to[0] - from[0], to[1] - from[1], 0.0]);
    Field::vector("displacement (mm)", vectors)
}

fn spatial([x, y]: Point) -> [f64; 3] {
    [x, y, 0.0]
}
