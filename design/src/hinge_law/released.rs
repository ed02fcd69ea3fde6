//! Hinges that were deformed and unloaded, each elastic about its residual deformation
//! ([`ReleasedHinge`]).

use crate::hinge_law::law::{HingeEnergy, Order, PreparedLaw};
use hinge::{HingeDeformation, HingeDesign, ReleasedHinge};
use std::sync::Arc;
use surrogate::{ByReleased, ReleasedGradient, Springback};

/// The law of the released hinges of one sheet, in its order. It knows no damage, and does not
/// depend on the designs.
#[derive(Clone, Copy, Debug)]
pub struct ReleasedLaw<'a>(pub &'a [ReleasedHinge]);

impl PreparedLaw for ReleasedLaw<'_> {
    fn energies(&self, deformations: &[HingeDeformation], _order: Order) -> Vec<HingeEnergy> {
        let energy = |(at, hinge): (&HingeDeformation, &ReleasedHinge)| HingeEnergy {
            w: hinge.energy(at),
            forces: hinge.forces(at),
            tangent: hinge.stiffness,
            ..HingeEnergy::default()
        };
        std::iter::zip(deformations, self.0).map(energy).collect()
    }
}

/// What becomes of the hinges of a sheet that is unloaded: the learned law, for another thickness
/// or a stronger material.
///
/// With all lengths in proportion to the thickness, F_a and F_s grow with its square and M_theta
/// with its cube.
#[derive(Clone, Debug)]
pub struct Release {
    law: Arc<Springback>,
    /// Thickness of the sheet over the thickness of the windows of the law.
    scale: f64,
    /// Stress at every strain over the stress of the material of the law.
    stress: f64,
}

impl Release {
    /// The law in a sheet of `scale` times the thickness of its windows.
    pub fn new(law: Springback, scale: f64) -> Self {
        let law = Arc::new(law);
        Self { law, scale, stress: 1.0 }
    }

    /// The same at `thickness` times the thickness and `stress` times the stress at every strain.
    pub(crate) fn scaled(&self, thickness: f64, stress: f64) -> Self {
        Self {
            law: Arc::clone(&self.law),
            scale: thickness * self.scale,
            stress: stress * self.stress,
        }
    }

    /// The hinges of a sheet that were unloaded from these states, with the forces of its prepared
    /// law.
    pub fn hinges(
        &self,
        law: &dyn PreparedLaw,
        designs: &[HingeDesign],
        states: &[HingeDeformation],
    ) -> Vec<ReleasedHinge> {
        let energies = law.energies(states, Order::Forces);
        std::iter::zip(designs, states)
            .zip(energies)
            .map(|((design, reached), energy)| self.hinge(design, reached, &energy.forces))
            .collect()
    }

    /// A hinge that was unloaded from a state with these forces (F_a, F_s, M_theta) (N, N, N mm).
    fn hinge(
        &self,
        design: &HingeDesign,
        reached: &HingeDeformation,
        forces: &[f64; 3],
    ) -> ReleasedHinge {
        let (design, reached, forces) = self.in_windows(design, reached, forces);
        let mut hinge = (self.law.released(&design, &reached, &forces)).scaled(self.scale);
        let stiffness = hinge.stiffness.as_flattened_mut();
        stiffness.iter_mut().for_each(|entry| *entry *= self.stress);
        hinge
    }

    /// The gradient in what [`hinge`](Self::hinge) follows from, of a function with the gradient
    /// `by` in the hinge.
    pub(crate) fn pullback(
        &self,
        design: &HingeDesign,
        reached: &HingeDeformation,
        forces: &[f64; 3],
        by: &ByReleased,
    ) -> ReleasedGradient {
        let (design, reached, forces) = self.in_windows(design, reached, forces);
        let lengths = [self.scale, self.scale, 1.0];
        let stiffness = |i: usize, j: usize| {
            // The same powers as in `ReleasedHinge::scaled`.
            let powers = self.scale.powi(3) / (lengths[i] * lengths[j]);
            self.stress * powers * by.stiffness[i][j]
        };
        let by = ByReleased {
            rest: std::array::from_fn(|i| lengths[i] * by.rest[i]),
            stiffness: std::array::from_fn(|i| std::array::from_fn(|j| stiffness(i, j))),
        };
        let found = (self.law).released_pullback(&design, &reached, &forces, &by);
        let units = self.force_units();
        ReleasedGradient {
            reached: std::array::from_fn(|i| found.reached[i] / lengths[i]),
            forces: std::array::from_fn(|i| found.forces[i] / units[i]),
            w_lig: found.w_lig / self.scale,
            alpha: found.alpha,
        }
    }

    /// The similar hinge in the windows of the law, with its forces.
    fn in_windows(
        &self,
        design: &HingeDesign,
        reached: &HingeDeformation,
        forces: &[f64; 3],
    ) -> (HingeDesign, HingeDeformation, [f64; 3]) {
        let (smaller, units) = (self.scale.recip(), self.force_units());
        let forces = std::array::from_fn(|i| forces[i] / units[i]);
        (design.scaled(smaller), reached.scaled(smaller), forces)
    }

    /// (F_a, F_s, M_theta) of the sheet over (F_a, F_s, M_theta) of the windows.
    fn force_units(&self) -> [f64; 3] {
        let square = self.stress * self.scale * self.scale;
        [square, square, square * self.scale]
    }
}
