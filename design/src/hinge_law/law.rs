//! The traits of a hinge law, which is prepared for the hinges of one sheet and then evaluated for
//! all of them.

pub use ::surrogate::{HingeDamage, HingeEnergy, Order};
pub use hinge::{DesignGradient, HingeGradient};

use hinge::{HingeDeformation, HingeDesign, TrainingDomain};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The damage measure of an objective.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum DamageMeasure {
    /// D, the mean over the ligament, as in the paper.
    #[default]
    Mean,
    /// D_peak, the mean over the most strained 1 % of the ligament: at 1 it tears.
    Peak,
}

impl DamageMeasure {
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
    /// Computes what depends only on the designs.
    fn prepare<'a>(&'a self, designs: &[HingeDesign]) -> Box<dyn PreparedLaw + 'a>;

    /// D_s of (17) for a measure, if the law predicts it.
    fn damage_scale(&self, _measure: DamageMeasure) -> Option<f64> {
        None
    }

    /// The training domain of the law, if it has one.
    fn domain(&self) -> Option<&TrainingDomain> {
        None
    }

    /// The law at `thickness` times the thickness and `stress` times the stress at every strain;
    /// `None` if the law does not determine it, see [`scales`](Self::scales).
    fn scaled(&self, _thickness: f64, _stress: f64) -> Option<Arc<dyn HingeLaw>> {
        None
    }

    /// Whether the law determines the law of a sheet of another thickness, and the law of a
    /// stronger material.
    fn scales(&self) -> [bool; 2] {
        [false; 2]
    }
}

/// A hinge law for the hinges of one sheet. Each method takes one deformation per hinge.
pub trait PreparedLaw: Sync {
    /// Energies with their derivatives up to `order`. Outside the range of a law the energy may be
    /// infinite; it is never NaN for finite deformations.
    fn energies(&self, deformations: &[HingeDeformation], order: Order) -> Vec<HingeEnergy>;

    /// The predicted damage (12); empty for a law that predicts none. Its gradients are zero unless
    /// they are requested.
    fn damage(&self, _deformations: &[HingeDeformation], _with_gradient: bool) -> Vec<HingeDamage> {
        Vec::new()
    }

    /// Whether the law is (11), with the constants (k_a, k_s, k_theta) at every hinge.
    fn has_constants(&self) -> bool {
        false
    }

    /// Deformation (translations divided by w_lig) below which the law's own rounding dominates.
    fn resolution(&self) -> f64 {
        0.0
    }

    /// Whether each hinge is inside the training domain of the law.
    fn inside(&self, deformations: &[HingeDeformation]) -> Vec<bool> {
        vec![true; deformations.len()]
    }
}
