//! What is kept of a sheet solve: the motion of every panel and the energy of every hinge at each
//! increment, and the surface at the last one.

use crate::SolvedPath;
use serde::{Deserialize, Serialize};
use std::array::from_fn;
use std::io;
use support::vtk::{CellKind, Field, UnstructuredGrid};

/// The converged increments of a sheet.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SheetStates {
    /// One state per increment, in order of lambda.
    pub states: Vec<SheetState>,
    /// The middle surface at the last increment; `None` without an increment.
    pub surface: Option<SheetSurface>,
    /// Number of unknowns of the mesh.
    pub unknowns: usize,
}

/// A converged increment of a sheet.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SheetState {
    /// Position on the path, from 0 to 1.
    pub lambda: f64,
    /// Fraction of the loads or of the stroke that is on.
    pub fraction: f64,
    /// Stroke of the loads (mm); 0 without loads.
    pub stroke: f64,
    /// Load factor: the measured loads over the full ones; 0 without loads.
    pub load_factor: f64,
    /// The motion of every panel.
    pub panels: Vec<PanelState>,
    /// The state of every hinge.
    pub hinges: Vec<HingeState>,
    /// Internal energy of the panels outside of the windows (N mm).
    pub panel_energy: f64,
    /// Kinetic energy (N mm); zero on a static path.
    pub kinetic_energy: f64,
    /// Reaction of each support (N), without the weight of what it holds itself; zero along what it
    /// leaves free in the plane.
    pub support_forces: Vec<[f64; 3]>,
}

/// A panel: the rigid motion in space that its nodes outside of the windows follow best, and what
/// is left of theirs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PanelState {
    /// Mean position of its nodes in the flat sheet (mm).
    pub centre: [f64; 3],
    /// Its displacement (mm).
    pub shift: [f64; 3],
    /// Rotation matrix, row by row.
    pub rotation: [[f64; 3]; 3],
    /// Largest distance of a node from the rigid panel along its normal (mm).
    pub bending: f64,
    /// Lowest and highest z of the outline of the rigid panel (mm).
    pub z: [f64; 2],
}

/// A hinge: what its window contains.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HingeState {
    /// Internal energy (N mm), stored and dissipated.
    pub energy: f64,
    /// D of (12).
    pub d: f64,
    /// D_peak.
    pub d_peak: f64,
}

/// The middle surface of a sheet; indices count from 0.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SheetSurface {
    /// Its nodes in the flat sheet, bumps included (mm).
    pub points: Vec<[f64; 3]>,
    /// Their displacements (mm).
    pub displacements: Vec<[f64; 3]>,
    /// Corners of each face, counter-clockwise.
    pub faces: Vec<Vec<usize>>,
    /// The index of the panel of each face, or the number of panels plus the index of the window of
    /// the face.
    pub parts: Vec<usize>,
    /// Largest plastic strain of the elements of each face; 0 in panels.
    pub plastic_strain: Vec<f64>,
}

impl SheetState {
    /// Largest tilt of a panel (rad).
    pub fn tilt(&self) -> f64 {
        (self.panels.iter()).fold(0.0, |most, panel| panel.tilt().max(most))
    }

    /// Lowest and highest z of the panels (mm).
    pub fn z(&self) -> [f64; 2] {
        let nothing = [f64::INFINITY, f64::NEG_INFINITY];
        (self.panels.iter())
            .fold(nothing, |[low, high], panel| [low.min(panel.z[0]), high.max(panel.z[1])])
    }

    /// Internal energy of windows and panels (N mm).
    pub fn internal_energy(&self) -> f64 {
        let of_hinges = self.hinges.iter().map(|hinge| hinge.energy);
        of_hinges.sum::<f64>() + self.panel_energy
    }
}

impl PanelState {
    /// The position of a point of the flat sheet on the rigid panel (mm).
    pub fn moved(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        let arm = [x - self.centre[0], y - self.centre[1], -self.centre[2]];
        from_fn(|i| {
            let turned: f64 = (0..3).map(|j| self.rotation[i][j] * arm[j]).sum();
            self.centre[i] + self.shift[i] + turned
        })
    }

    /// Rotation in the plane, counter-clockwise (rad).
    pub fn turn(&self) -> f64 {
        let r = &self.rotation;
        (r[1][0] - r[0][1]).atan2(r[0][0] + r[1][1])
    }

    /// Angle between the normal of the panel and the normal of the sheet (rad).
    pub fn tilt(&self) -> f64 {
        let r = &self.rotation;
        f64::hypot(r[0][2], r[1][2]).atan2(r[2][2])
    }
}

impl SheetSurface {
    /// Angle (deg) between the normal of each face and the normal of the flat sheet.
    pub fn tilts_deg(&self) -> Vec<f64> {
        let deformed = self.deformed();
        let tilt = |face: &Vec<usize>| {
            // Twice the area of the polygon as a vector.
            let edges = (0..face.len()).map(|i| (face[i], face[(i + 1) % face.len()]));
            let normal = edges.fold([0.0; 3], |sum, (from, to)| {
                let (p, q) = (deformed[from], deformed[to]);
                from_fn(|i| {
                    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                    sum[i] + p[j] * q[k] - p[k] * q[j]
                })
            });
            let [x, y, z]: [f64; 3] = normal;
            x.hypot(y).atan2(z).to_degrees()
        };
        self.faces.iter().map(tilt).collect()
    }

    /// The surface with its displacements, for ParaView.
    pub fn grid(&self) -> UnstructuredGrid {
        UnstructuredGrid {
            points: self.points.clone(),
            kind: CellKind::Polygon,
            cells: self.faces.clone(),
            point_data: vec![Field::vector(
                "displacement (mm)",
                self.displacements.iter().copied(),
            )],
            cell_data: vec![
                Field::scalar("part", self.parts.iter().map(|part| *part as f64)),
                Field::scalar("tilt (deg)", self.tilts_deg()),
                Field::scalar("plastic strain, maximum", self.plastic_strain.iter().copied()),
            ],
        }
    }

    /// Deformed positions of the points (mm).
    pub fn deformed(&self) -> Vec<[f64; 3]> {
        std::iter::zip(&self.points, &self.displacements)
            .map(|(point, moved)| [0, 1, 2].map(|i| point[i] + moved[i]))
            .collect()
    }
}

impl SolvedPath for SheetStates {
    const FILE: &'static str = "states.json";

    fn len(&self) -> usize {
        self.states.len()
    }

    fn reached(&self) -> f64 {
        self.states.last().map_or(0.0, |state| state.lambda)
    }

    fn to_bytes(&self) -> io::Result<Vec<u8>> {
        Ok(serde_json::to_vec(self)?)
    }

    fn from_bytes(bytes: &[u8]) -> io::Result<Self> {
        Ok(serde_json::from_slice(bytes)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tilt_and_turn_are_those_of_the_rotation() {
        let (tilt, turn) = (0.3_f64, 0.7_f64);
        let about_x =
            [[1.0, 0.0, 0.0], [0.0, tilt.cos(), -tilt.sin()], [0.0, tilt.sin(), tilt.cos()]];
        let panel = PanelState {
            rotation: about_x,
            centre: [1.0, 2.0, 0.0],
            shift: [0.0, 0.0, 5.0],
            ..PanelState::default()
        };
        assert!((panel.tilt() - tilt).abs() < 1e-15 && panel.turn().abs() < 1e-15);
        let [x, y, z] = panel.moved([1.0, 3.0]);
        assert!((x - 1.0).abs() < 1e-15 && (y - 2.0 - tilt.cos()).abs() < 1e-15);
        assert!((z - 5.0 - tilt.sin()).abs() < 1e-15);
        let flat = PanelState {
            rotation: [
                [turn.cos(), -turn.sin(), 0.0],
                [turn.sin(), turn.cos(), 0.0],
                [0.0, 0.0, 1.0],
            ],
            ..PanelState::default()
        };
        assert!((flat.turn() - turn).abs() < 1e-15 && flat.tilt() == 0.0);
    }
}
