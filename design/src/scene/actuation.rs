//! Supports and loads as written in a scene, with panels named by [column, row].

use crate::pattern::grid::Grid;
use serde::{Deserialize, Serialize};

/// A supported panel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SupportConfig {
    pub panel: [usize; 2],
    pub kind: SupportKind,
    /// Displacement of the supported translations at full load (mm).
    #[serde(default)]
    pub displacement: [f64; 2],
    /// Rotation of a supported rotation at full load, counter-clockwise (deg).
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
    /// Rolls along x: the translation along y is prescribed.
    RollerX,
    /// Rolls along y: the translation along x is prescribed.
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

/// A dead traction along an edge of the flat sheet. Its resultant is divided equally among the panels of
/// the edge and acts at their centroids, so the loads do not change with the pattern.
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

/// Self-equilibrated couples on the two panels of a hinge that open it. The couple on a panel whose rotation is
/// supported would do no work and is left out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OpeningCoupleConfig {
    /// Two neighbouring panels; by default every hinge of the sheet.
    pub panels: Option<[[usize; 2]; 2]>,
    /// N mm, positive to open.
    pub couple: f64,
}

/// Displacement control: the stroke of the loads is prescribed; the load factor is an unknown.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveConfig {
    /// Stroke at the end of the path: work of the full loads divided by the sum of their magnitudes (mm).
    pub stroke: f64,
}

impl SupportKind {
    /// Whether (u_x, u_y, phi) are prescribed.
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
    pub(super) fn panels(self, grid: Grid) -> Vec<usize> {
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
