//! Supports and dead loads of the sheet; (10).
//!
//! A pin supports both translations of a panel, a roller one of them, a clamp
//! all three degrees of freedom.

use crate::sheet::cut_sheet::Sheet;
use serde::{Deserialize, Serialize};

/// Lever of the supports about the centre of rotation, relative to the size of the sheet, below
/// which they do not prevent the rotation.
const MIN_LEVER: f64 = 1e-6;

/// A degree of freedom of a panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Dof {
    /// Translation of the reference point along x (mm).
    UX,
    /// Translation of the reference point along y (mm).
    UY,
    /// Rotation about the reference point, counter-clockwise (rad).
    Phi,
}

/// A prescribed motion of a panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Support {
    /// Index of the panel.
    pub panel: usize,
    /// The supported degree of freedom.
    pub dof: Dof,
    /// Value at full load (mm or rad); it grows with the load factor.
    pub value: f64,
}

/// A dead load at a panel's reference point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Index of the panel.
    pub panel: usize,
    /// The degree of freedom that the load does work on.
    pub dof: Dof,
    /// Value at full load: a force (N) for a translation, a moment (N mm) for the rotation.
    pub value: f64,
}

impl Dof {
    /// All degrees of freedom of a panel, in the order of its motion (u_x, u_y, phi).
    pub const ALL: [Self; 3] = [Self::UX, Self::UY, Self::Phi];

    /// Position in a panel's motion (u_x, u_y, phi).
    pub fn index(self) -> usize {
        self as usize
    }
}

/// Whether the supports prevent the three rigid motions of the flat sheet.
pub(crate) fn hold_rigid_body(supports: &[Support], sheet: &Sheet) -> bool {
    let size = sheet.outline.area().sqrt();
    let [x_0, y_0] = sheet.outline.corners[0];
    // Two translations and the rotation about a corner, which moves a point as far away as the
    // sheet is large by one.
    let rows = supports.iter().map(|support| {
        let [x, y] = sheet.panels[support.panel].reference;
        match support.dof {
            Dof::UX => [1.0, 0.0, (y_0 - y) / size],
            Dof::UY => [0.0, 1.0, (x - x_0) / size],
            Dof::Phi => [0.0, 0.0, 1.0],
        }
    });
    let mut gram = [[0.0; 3]; 3];
    for row in rows {
        for i in 0..3 {
            for j in 0..3 {
                gram[i][j] += row[i] * row[j];
            }
        }
    }
    // The square of the lever is what the translations leave of the rotation.
    let [along_x, along_y, turned] = gram;
    if along_x[0] == 0.0 || along_y[1] == 0.0 {
        return false;
    }
    let left = turned[2] - turned[0] * turned[0] / along_x[0] - turned[1] * turned[1] / along_y[1];
    left > MIN_LEVER * MIN_LEVER
}
