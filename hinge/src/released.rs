//! A hinge that was deformed and unloaded: its residual deformation, and how stiff the hinge is
//! about that.

use crate::HingeDeformation;
use std::array::from_fn;

/// The elastic energy of a released hinge, about its deformation without forces:
///
/// ```text
/// E(x) = (x - r) . K (x - r) / 2,        x = (a, s, theta)
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ReleasedHinge {
    /// r: the deformation without forces (mm, mm, rad).
    pub rest: HingeDeformation,
    /// K, symmetric and positive definite (N/mm, N, N mm).
    pub stiffness: [[f64; 3]; 3],
}

impl ReleasedHinge {
    /// K (x - r): the forces (F_a, F_s, M_theta) at a deformation.
    pub fn forces(&self, at: &HingeDeformation) -> [f64; 3] {
        let (at, rest) = (at.to_array(), self.rest.to_array());
        from_fn(|i| (0..3).map(|j| self.stiffness[i][j] * (at[j] - rest[j])).sum())
    }

    /// The energy at a deformation (N mm).
    pub fn energy(&self, at: &HingeDeformation) -> f64 {
        let (forces, at, rest) = (self.forces(at), at.to_array(), self.rest.to_array());
        0.5 * (0..3).map(|i| forces[i] * (at[i] - rest[i])).sum::<f64>()
    }

    /// The similar hinge in a sheet of `factor` times the thickness.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        // Forces grow with the square of the thickness, (a, s) with the thickness.
        let length = [1.0, 1.0, factor];
        Self {
            rest: self.rest.scaled(factor),
            stiffness: from_fn(|i| {
                from_fn(|j| factor * self.stiffness[i][j] * length[i] * length[j])
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hinge() -> ReleasedHinge {
        ReleasedHinge {
            rest: [-0.4, 0.1, 0.3].into(),
            stiffness: [[9.0, 1.0, -4.0], [1.0, 20.0, 2.0], [-4.0, 2.0, 30.0]],
        }
    }

    #[test]
    fn forces_are_the_gradient_of_the_energy_and_vanish_at_rest() {
        let hinge = hinge();
        assert_eq!(hinge.forces(&hinge.rest), [0.0; 3]);
        let at = [0.2, -0.3, 0.8];
        let forces = hinge.forces(&at.into());
        for i in 0..3 {
            let energy = |h: f64| {
                let mut moved = at;
                moved[i] += h;
                hinge.energy(&moved.into())
            };
            let slope = (energy(1e-4) - energy(-1e-4)) / 2e-4;
            assert!((slope - forces[i]).abs() < 1e-8, "{i}: {slope} {forces:?}");
        }
    }

    #[test]
    fn the_energy_of_similar_hinges_grows_with_the_cube_of_the_thickness() {
        let (hinge, at) = (hinge(), HingeDeformation::from([0.2, -0.3, 0.8]));
        let energy = hinge.energy(&at);
        let similar = hinge.scaled(2.0).energy(&at.scaled(2.0));
        assert!((similar / (8.0 * energy) - 1.0).abs() < 1e-12);
    }
}
