//! The prescribed motion of arc B along a path.
//!
//! Panel A is fixed. Panel B rotates by theta about O, and O on B moves by du = R(theta/2) (a, s),
//! so that (a, s, theta) are measured in the mean frame of (8). A point of arc B at the position
//! (X, Y) relative to O therefore moves by
//!
//! u_x = X q1 - Y q2 + q3,   u_y = Y q1 + X q2 + q4,   q = (cos theta - 1, sin theta, du_x, du_y),
//!
//! which is linear in the four numbers q at any rotation. These depend only on lambda.

use hinge::{HingeDeformation, HingeForces};

/// The motion of panel B relative to A that corresponds to a deformation in the mean frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PanelMotion {
    /// Rotation about O (rad).
    pub theta: f64,
    /// Displacement of O on panel B (mm), in the frame of panel A.
    pub du: [f64; 2],
}

impl PanelMotion {
    /// du = R(theta/2) (a, s).
    pub fn new(deformation: &HingeDeformation) -> Self {
        Self {
            theta: deformation.theta,
            du: rotated([deformation.a, deformation.s], 0.5 * deformation.theta),
        }
    }

    /// The amplitudes (q1, q2, q3, q4) of the four control degrees of freedom.
    pub fn amplitudes(&self) -> [f64; 4] {
        // cos(theta) - 1 without cancellation.
        let q1 = -2.0 * (0.5 * self.theta).sin().powi(2);
        [q1, self.theta.sin(), self.du[0], self.du[1]]
    }

    /// (F_a, F_s, M_theta) from the resultant `force` (N) on panel B and its `moment` (N mm) about
    /// the current position of O on B. They are the gradient of the work with respect to (a, s,
    /// theta); M_theta has a contribution of the force because du rotates with theta/2.
    pub fn forces(&self, force: [f64; 2], moment: f64) -> HingeForces {
        let [f_a, f_s] = rotated(force, -0.5 * self.theta);
        HingeForces {
            f_a,
            f_s,
            m_theta: moment + 0.5 * (self.du[0] * force[1] - self.du[1] * force[0]),
        }
    }
}

/// The vector (x, y) rotated counter-clockwise by `angle` (rad).
pub(crate) fn rotated([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The displaced position of a point at `x` relative to O.
    fn moved(deformation: [f64; 3], x: [f64; 2]) -> [f64; 2] {
        let [q1, q2, q3, q4] = PanelMotion::new(&deformation.into()).amplitudes();
        [x[0] + x[0] * q1 - x[1] * q2 + q3, x[1] + x[1] * q1 + x[0] * q2 + q4]
    }

    proptest! {
        #[test]
        fn the_motion_is_rigid(a in -9.0..9.0f64, s in -9.0..9.0f64, theta in 0.0..1.4f64) {
            let (p, q) = ([80.0, -30.0], [-20.0, -90.0]);
            let [p1, q1] = [p, q].map(|x| moved([a, s, theta], x));
            let before = (p[0] - q[0]).hypot(p[1] - q[1]);
            prop_assert!(((p1[0] - q1[0]).hypot(p1[1] - q1[1]) - before).abs() < 1e-11);
        }

        /// Virtual work: forces . d(a, s, theta) = sum of nodal force . d(position).
        #[test]
        fn forces_are_conjugate_to_the_mean_frame(
            a in -9.0..9.0f64, s in -9.0..9.0f64, theta in 0.0..1.4f64,
            fx in -1.0..1.0f64, fy in -1.0..1.0f64
        ) {
            let x = [80.0, -30.0];
            let motion = PanelMotion::new(&HingeDeformation { a, s, theta });
            let arm = rotated(x, theta);
            let forces = motion.forces([fx, fy], arm[0] * fy - arm[1] * fx);
            let expected = [forces.f_a, forces.f_s, forces.m_theta];
            for i in 0..3 {
                let h = 1e-5;
                let (mut plus, mut minus) = ([a, s, theta], [a, s, theta]);
                plus[i] += h;
                minus[i] -= h;
                let (p, q) = (moved(plus, x), moved(minus, x));
                let work = (fx * (p[0] - q[0]) + fy * (p[1] - q[1])) / (2.0 * h);
                prop_assert!((work - expected[i]).abs() < 1e-6 * (1.0 + expected[i].abs()));
            }
        }
    }
}
