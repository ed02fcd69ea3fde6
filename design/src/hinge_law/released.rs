//! Hinges that were deformed and let go, each elastic about the deformation that stays ([`ReleasedHinge`]).

use crate::hinge_law::law::{HingeEnergy, HingeLaw, Order, PreparedLaw};
use hinge::{HingeDeformation, HingeDesign, ReleasedHinge};

/// The law of the released hinges of one sheet. It knows no damage, and does not depend on the designs.
#[derive(Clone, Debug)]
pub struct ReleasedLaw(
    /// One for each hinge, in the order of the sheet.
    pub Vec<ReleasedHinge>,
);

impl HingeLaw for ReleasedLaw {
    fn prepare<'a>(&'a self, _designs: &[HingeDesign]) -> Box<dyn PreparedLaw + 'a> {
        Box::new(Prepared(&self.0))
    }
}

struct Prepared<'a>(&'a [ReleasedHinge]);

impl PreparedLaw for Prepared<'_> {
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
