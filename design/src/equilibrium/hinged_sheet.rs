//! The sheet together with the stored energy of its hinges.

use crate::{
    hinge_law::{Contact, HingeEnergy, Order, PreparedLaw},
    sheet::cut_sheet::Sheet,
};
use hinge::HingeDeformation;

/// The sheet together with the energy of its hinges.
#[derive(Clone, Copy)]
pub struct HingedSheet<'a> {
    /// The flat sheet.
    pub sheet: &'a Sheet,
    /// The hinge law, prepared for the hinges of the sheet.
    pub law: &'a dyn PreparedLaw,
    /// Contact of panel edges; `None` without contact.
    pub contact: Option<&'a Contact>,
    /// Whether gradients of the damage along the path are computed, and with them the derivatives
    /// that the adjoint needs.
    pub damage_gradient: bool,
}

impl HingedSheet<'_> {
    /// Sum of the energies of law and contact.
    pub fn energies(&self, deformations: &[HingeDeformation], order: Order) -> Vec<HingeEnergy> {
        let mut energies = self.law.energies(deformations, order);
        if let Some(contact) = self.contact {
            contact.add(&mut energies, deformations);
        }
        energies
    }
}
