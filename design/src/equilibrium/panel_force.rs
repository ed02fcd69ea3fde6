//! The weight of a panel as a force, in addition to the forces of its hinges.

/// A force on a panel in one of its positions, with its derivative.
#[derive(Clone, Copy, Default)]
pub(crate) struct PanelForce {
    /// (F_x, F_y, M) about the reference point of the panel.
    pub force: [f64; 3],
    /// Minus the derivative of `force` in the motion of the panel.
    pub stiffness: [[f64; 3]; 3],
    /// The potential energy of the force (N mm).
    pub potential: f64,
}

impl PanelForce {
    /// The resistance of the stiffness to a motion.
    pub(crate) fn resistance(&self, motion: &[f64; 3]) -> [f64; 3] {
        self.stiffness.map(|row| row[0] * motion[0] + row[1] * motion[1] + row[2] * motion[2])
    }
}
