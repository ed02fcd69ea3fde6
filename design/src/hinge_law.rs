//! The stored energy of a hinge as a function of its deformation and design (9), behind one trait.
//!
//! | law | energy | needs |
//! |---|---|---|
//! | [`LinearLaw`] | (11), three springs | constants |
//! | [`CondensedLaw`] | (11) with the constants of a learned energy | weights |
//! | [`SurrogateLaw`] | (14), continued beyond the training domain | weights |
//!
//! A law is first prepared for the hinges of one sheet and then evaluated for all of them at once.

mod condensed;
mod contact;
mod linear;
mod surrogate;

pub use ::surrogate::{HingeDamage, HingeEnergy, Order};
pub use condensed::{CondensedLaw, Constant};
pub use contact::{Contact, InvalidContact};
pub use linear::{InvalidStiffness, LinearLaw};
pub use surrogate::SurrogateLaw;

use hinge::{HingeDeformation, HingeDesign, TrainingDomain};
use serde::{Deserialize, Serialize};

/// Which damage an objective weighs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DamageMeasure {
    /// D, the mean over the ligament, as the paper.
    #[default]
    Mean,
    /// D_peak, the mean over the most strained 1 % of the ligament: at 1 it tears.
    Peak,
}

impl DamageMeasure {
    /// The damage of a hinge by this measure and its gradient in (a, s, theta, w_lig, alpha); zero where the
    /// law does not predict it.
    pub fn of(self, damage: &HingeDamage) -> (f64, [f64; 5]) {
        let gradient = match self {
            Self::Mean => damage.gradient,
            Self::Peak => damage.peak_gradient,
        };
        (self.known(damage).unwrap_or(0.0), gradient)
    }

    /// The damage of a hinge by this measure, if the law predicts it.
    pub fn known(self, damage: &HingeDamage) -> Option<f64> {
        match self {
            Self::Mean => Some(damage.d),
            Self::Peak => damage.d_peak,
        }
    }
}

/// A stored-energy function of the hinge deformation, for any hinge design.
pub trait HingeLaw: Send + Sync {
    /// Does once what depends on the designs alone.
    fn prepare<'a>(&'a self, designs: &[HingeDesign]) -> Box<dyn PreparedLaw + 'a>;

    /// D_s of (17) for a measure, if the law predicts it.
    fn damage_scale(&self, _measure: DamageMeasure) -> Option<f64> {
        None
    }

    /// What the law was trained on, if it was.
    fn domain(&self) -> Option<&TrainingDomain> {
        None
    }
}

/// A hinge law for the hinges of one sheet. Each method takes one deformation per hinge.
pub trait PreparedLaw {
    /// Energies with their derivatives up to `order`. Beyond a law's reach the energy may be
    /// infinite; it is never NaN for finite deformations.
    fn energies(&self, deformations: &[HingeDeformation], order: Order) -> Vec<HingeEnergy>;

    /// The predicted damage (12); empty for a law that predicts none.
    fn damage(&self, _deformations: &[HingeDeformation]) -> Vec<HingeDamage> {
        Vec::new()
    }

    /// Whether the law is (11), with the constants (k_a, k_s, k_theta) at every hinge.
    fn has_constants(&self) -> bool {
        false
    }

    /// Deformation, of translations over w_lig, that is lost in the law's own rounding.
    fn resolution(&self) -> f64 {
        0.0
    }

    /// Which hinges are in a state that the law was made for.
    fn inside(&self, deformations: &[HingeDeformation]) -> Vec<bool> {
        vec![true; deformations.len()]
    }
}
