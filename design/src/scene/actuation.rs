//! Supports and loads as a scene writes them, panels named by [column, row].

use super::Scene;
use crate::actuation::{Dof, Load, Support};
use crate::grid::{EDGES, Grid};
use crate::topology::{HingeSite, hinge_sites};
use serde::{Deserialize, Serialize};

/// A held panel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SupportConfig {
    pub panel: [usize; 2],
    pub kind: SupportKind,
    /// Motion of the held translations at full load (mm).
    #[serde(default)]
    pub displacement: [f64; 2],
    /// Motion of the held rotation at full load, counter-clockwise (deg).
    #[serde(default)]
    pub rotation_deg: f64,
}

/// Which motions of a panel's centroid a support prescribes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SupportKind {
    /// Both translations and the rotation.
    Clamp,
    /// Both translations.
    Pin,
    /// Rolls along x: the translation along y.
    RollerX,
    /// Rolls along y: the translation along x.
    RollerY,
}

/// A dead load at the centroid of a panel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoadConfig {
    pub panel: [usize; 2],
    /// N
    #[serde(default)]
    pub force: [f64; 2],
    /// N mm, counter-clockwise.
    #[serde(default)]
    pub couple: f64,
}

/// A dead traction along an edge of the flat sheet. Its resultant is shared alike by the panels of
/// the edge and acts at their centroids: the actuation does not change with the pattern.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EdgeLoadConfig {
    pub edge: SheetEdge,
    /// N/mm
    pub traction: [f64; 2],
}

/// An edge of the outline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SheetEdge {
    Bottom,
    Right,
    Top,
    Left,
}

/// Self-equilibrated couples on the two panels of a hinge, which open it; what a support holds does
/// no work and is left out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OpeningCoupleConfig {
    /// Two neighbours; by default every hinge of the sheet.
    pub panels: Option<[[usize; 2]; 2]>,
    /// N mm, positive to open.
    pub couple: f64,
}

/// Displacement control: the load factor follows from the way of the loads.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveConfig {
    /// Work of the full loads over the sum of their forces, at the end of the path (mm).
    pub stroke: f64,
}

impl SupportKind {
    /// Whether (u_x, u_y, phi) are held.
    pub fn holds(self) -> [bool; 3] {
        match self {
            Self::Clamp => [true, true, true],
            Self::Pin => [true, true, false],
            Self::RollerX => [false, true, false],
            Self::RollerY => [true, false, false],
        }
    }
}

impl SupportConfig {
    /// (u_x, u_y, phi) at full load (mm, mm, rad).
    pub fn motion(&self) -> [f64; 3] {
        let [x, y] = self.displacement;
        [x, y, self.rotation_deg.to_radians()]
    }
}

impl LoadConfig {
    /// Multiplies force and couple.
    pub fn scale(&mut self, factor: f64) {
        self.force = self.force.map(|force| factor * force);
        self.couple *= factor;
    }
}

impl SheetEdge {
    fn panels(self, grid: Grid) -> Vec<usize> {
        let row = |q| (0..grid.m).map(|p| grid.panel(p, q)).collect();
        let column = |p| (0..grid.n).map(|q| grid.panel(p, q)).collect();
        match self {
            Self::Bottom => row(0),
            Self::Right => column(grid.m - 1),
            Self::Top => row(grid.n - 1),
            Self::Left => column(0),
        }
    }
}

impl Scene {
    pub(super) fn supports(&self) -> Vec<Support> {
        let mut supports = Vec::new();
        for config in &self.config.supports {
            let panel = self.panel(config.panel);
            let motion = config.motion();
            for (dof, held) in Dof::ALL.into_iter().zip(config.kind.holds()) {
                if held {
                    let value = motion[dof.index()];
                    supports.push(Support { panel, dof, value });
                }
            }
        }
        supports
    }

    /// The loads of the panels, of the edges and of the hinges together.
    pub fn loads(&self) -> Vec<Load> {
        let mut total = vec![[0.0; 3]; self.grid().panel_count()];
        for load in &self.config.loads {
            let sum = &mut total[self.panel(load.panel)];
            sum[0] += load.force[0];
            sum[1] += load.force[1];
            sum[2] += load.couple;
        }
        for load in &self.config.edge_loads {
            let [from, to] =
                EDGES[load.edge as usize].map(|k| self.config.sheet.outline().corners[k]);
            let length = f64::hypot(to[0] - from[0], to[1] - from[1]);
            let panels = load.edge.panels(self.grid());
            let [x, y] = load.traction.map(|t| t * length / panels.len() as f64);
            for panel in panels {
                total[panel][0] += x;
                total[panel][1] += y;
            }
        }
        for load in &self.config.opening_couples {
            let pair = load
                .panels
                .map(|panels| panels.map(|panel| self.panel(panel)));
            for HingeSite { a, b, .. } in hinge_sites(self.grid()) {
                if pair.is_none_or(|pair| pair.contains(&a.0) && pair.contains(&b.0)) {
                    total[a.0][2] -= load.couple;
                    total[b.0][2] += load.couple;
                }
            }
        }
        for support in self.supports() {
            total[support.panel][support.dof.index()] = 0.0;
        }
        let loads = total.iter().enumerate().flat_map(|(panel, values)| {
            let load = move |(dof, &value)| Load { panel, dof, value };
            Dof::ALL.into_iter().zip(values).map(load)
        });
        loads.filter(|load| load.value != 0.0).collect()
    }

    fn panel(&self, [column, row]: [usize; 2]) -> usize {
        self.grid().panel(column, row)
    }
}
