//! The linear hinge law (11): W = (k_a a^2 + k_s s^2 + k_theta theta^2) / 2.

use crate::hinge_law::law::{HingeEnergy, HingeLaw, Order, PreparedLaw};
use hinge::{HingeDeformation, HingeDesign};
use std::sync::Arc;

/// Three uncoupled springs per hinge.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearLaw {
    /// (k_a, k_s, k_theta) per hinge, all positive (N/mm, N/mm, N mm).
    pub stiffness: Vec<[f64; 3]>,
}

impl LinearLaw {
    /// The same constants at all `hinges` hinges.
    pub fn uniform(stiffness: [f64; 3], hinges: usize) -> Self {
        Self { stiffness: vec![stiffness; hinges] }
    }
}

impl HingeLaw for LinearLaw {
    /// # Panics
    /// If the number of triples of constants differs from the number of hinges.
    fn prepare<'a>(&'a self, designs: &[HingeDesign]) -> Box<dyn PreparedLaw + 'a> {
        assert_eq!(self.stiffness.len(), designs.len(), "one triple per hinge");
        Box::new(self)
    }

    /// The constants of another thickness are unknown.
    fn scaled(&self, thickness: f64, stress: f64) -> Option<Arc<dyn HingeLaw>> {
        let scaled = |constants: &[f64; 3]| constants.map(|constant| stress * constant);
        (thickness == 1.0).then(|| -> Arc<dyn HingeLaw> {
            Arc::new(Self { stiffness: self.stiffness.iter().map(scaled).collect() })
        })
    }

    fn scales(&self) -> [bool; 2] {
        [false, true]
    }
}

impl PreparedLaw for &LinearLaw {
    fn energies(&self, deformations: &[HingeDeformation], _order: Order) -> Vec<HingeEnergy> {
        std::iter::zip(deformations, &self.stiffness)
            .map(|(deformation, constants)| spring(deformation.to_array(), constants))
            .collect()
    }

    fn has_constants(&self) -> bool {
        true
    }
}

/// The energy of three springs, without derivatives in the design.
pub(super) fn spring(deformation: [f64; 3], constants: &[f64; 3]) -> HingeEnergy {
    let mut energy = HingeEnergy::default();
    for c in 0..3 {
        energy.forces[c] = constants[c] * deformation[c];
        energy.tangent[c][c] = constants[c];
        energy.w += 0.5 * energy.forces[c] * deformation[c];
    }
    energy
}
