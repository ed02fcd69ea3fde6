//! Hinges that were deformed and unloaded, each elastic about its residual deformation
//! ([`ReleasedHinge`]).

use crate::hinge_law::law::{HingeEnergy, Order, PreparedLaw};
use hinge::{HingeDeformation, HingeDesign, ReleasedHinge};
use std::iter::zip;
use surrogate::Springback;

/// The law of the unloaded hinges of one sheet, in its order. It knows no damage, and does not
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
        zip(deformations, self.0).map(energy).collect()
    }
}

/// The learned law of unloaded hinges, for another thickness.
///
/// If all lengths are in proportion to the thickness, F_a and F_s grow with its square and M_theta
/// with its cube.
#[derive(Clone, Copy, Debug)]
pub struct Release<'a> {
    /// The law at the thickness of its windows.
    pub law: &'a Springback,
    /// Thickness of the sheet over the thickness of the windows.
    pub scale: f64,
}

impl Release<'_> {
    /// The hinges of a sheet that were unloaded from these states, with the forces of its prepared
    /// law.
    pub fn hinges(
        &self,
        law: &dyn PreparedLaw,
        designs: &[HingeDesign],
        states: &[HingeDeformation],
    ) -> Vec<ReleasedHinge> {
        let smaller = self.scale.recip();
        let square = self.scale * self.scale;
        let force_units = [square, square, square * self.scale];
        let energies = law.energies(states, Order::Forces);
        zip(designs, states)
            .zip(energies)
            .map(|((design, reached), energy)| {
                let forces = std::array::from_fn(|i| energy.forces[i] / force_units[i]);
                let (design, reached) = (design.scaled(smaller), reached.scaled(smaller));
                self.law.released(&design, &reached, &forces).scaled(self.scale)
            })
            .collect()
    }
}
