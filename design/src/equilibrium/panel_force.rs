//! Forces that act on the panels themselves, besides those of the hinges: their weight, their friction on a surface.

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
    pub fn add(&mut self, other: &Self) {
        self.potential += other.potential;
        for i in 0..3 {
            self.force[i] += other.force[i];
            for j in 0..3 {
                self.stiffness[i][j] += other.stiffness[i][j];
            }
        }
    }

    /// The resistance of the stiffness to a motion.
    pub fn resistance(&self, motion: &[f64; 3]) -> [f64; 3] {
        self.stiffness
            .map(|row| row[0] * motion[0] + row[1] * motion[1] + row[2] * motion[2])
    }
}
