//! Supports and dead loads of the sheet; (10).
//!
//! A pin supports both translations of a panel, a roller one of them, a clamp
//! all three degrees of freedom.

use serde::{Deserialize, Serialize};

/// A degree of freedom of a panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Dof {
    /// Translation of the centroid along x (mm).
    UX,
    /// Translation of the centroid along y (mm).
    UY,
    /// Rotation about the centroid, counter-clockwise (rad).
    Phi,
}

/// A prescribed motion of a panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Support {
    /// Index of the panel.
    pub panel: usize,
    /// The supported degree of freedom.
    pub dof: Dof,
    /// At full load (mm or rad); it grows with the load factor.
    pub value: f64,
}

/// A dead load at a panel's centroid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Index of the panel.
    pub panel: usize,
    /// The degree of freedom that the load does work on.
    pub dof: Dof,
    /// At full load: a force (N) for a translation, a moment (N mm) for the rotation.
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
