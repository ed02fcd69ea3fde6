//! The condensed hinge energy (14): a learned potential of the hinge deformation.
//!
//! ```text
//! W(eps; g) = W_s |chi(xi(eps, g)) - chi(xi(0, g))|^2
//! D(eps; g) = D_s softplus(chi_D(xi(eps, g))),   and D_peak likewise from a second output
//! xi(eps, g) = [a / w_lig, s / w_lig, theta, log w_lig, alpha]                  (13)
//! ```
//!
//! The squared distance makes W >= 0, W(0) = 0 and grad W(0) = 0 for any weights. A surrogate is
//! loaded from `X.safetensors` and its card `X.json`, and evaluated in float64 for many hinges at
//! once:
//!
//! | file | idea |
//! |---|---|
//! | `features` | the features (13) and their standardisation |
//! | `network` | a tanh network, checked |
//! | `passes` | batched value, tangents and reverse pass through a network |
//! | `tanh` | a branch-free tanh that vectorises |
//! | `energy` | W and its derivatives in deformation and design |
//! | `damage` | D and D_peak with their gradients |
//! | `card` | what the weights were trained on, and how well they fit |
//! | `weights` | reading and writing the two files |

mod card;
mod damage;
mod energy;
mod features;
mod network;
mod passes;
mod tanh;
mod weights;

pub use card::{Card, ErrorBin, FORMAT_VERSION, FitError, TestErrors, UNITS};
pub use damage::HingeDamage;
pub use energy::{HingeEnergy, Order, Prepared};
pub use features::{FEATURE_NAMES, Standardisation, features};
pub use network::{InvalidWeights, Layer, Network, Tensor};
pub use tanh::tanh_in_place;
pub use weights::WeightsError;

use hinge::{HingeDeformation, HingeDesign, TrainingDomain};
use std::path::Path;

/// The two networks of (14) with everything needed to evaluate and to describe them.
#[derive(Clone, Debug)]
pub struct Surrogate {
    /// The embedding chi, of any number of outputs.
    chi: Network,
    /// The damage head chi_D: D, and D_peak if it has a second output.
    chi_d: Network,
    card: Card,
}

impl Surrogate {
    /// Joins networks and card.
    ///
    /// The networks take the standardised features; `chi_d` has one output for each damage scale
    /// of the card.
    pub fn from_parts(
        chi: Vec<Layer>,
        chi_d: Vec<Layer>,
        card: Card,
    ) -> Result<Self, InvalidWeights> {
        card.validate()?;
        let chi = Network::new("chi", chi, None, &card.standardisation)?;
        let outputs = Some(card.damage_scales().len());
        let chi_d = Network::new("chi_d", chi_d, outputs, &card.standardisation)?;
        Ok(Self { chi, chi_d, card })
    }

    /// The same surrogate with errors on its card, which can only be measured once it exists.
    pub fn with_test_errors(mut self, test_errors: TestErrors, bins: Vec<ErrorBin>) -> Self {
        self.card.test_errors = test_errors;
        self.card.error_bins = bins;
        self
    }

    /// Reads `X.safetensors` and the card `X.json` beside it.
    pub fn load(weights: &Path) -> Result<Self, WeightsError> {
        weights::load(weights)
    }

    /// Writes `X.safetensors` and the card `X.json` beside it, each beside its place and renamed.
    pub fn save(&self, weights: &Path) -> Result<(), WeightsError> {
        weights::save(self, weights)
    }

    /// What the weights were trained on, and how well they fit.
    pub fn card(&self) -> &Card {
        &self.card
    }

    /// The layers of chi and of chi_D, as they are written.
    pub fn layers(&self) -> [&[Layer]; 2] {
        [self.chi.layers(), self.chi_d.layers()]
    }

    /// The box of hinge states in the training data.
    pub fn domain(&self) -> &TrainingDomain {
        &self.card.domain
    }

    /// W_s of (14): the root mean square of the training energies (N mm).
    pub fn energy_scale(&self) -> f64 {
        self.card.energy_scale
    }

    /// D_s of (14): the root mean square of the training damage.
    pub fn damage_scale(&self) -> f64 {
        self.card.damage_scale
    }

    /// Caches what depends on the designs alone: chi(xi(0, g)) and its derivative in g.
    pub fn prepare(&self, designs: &[HingeDesign]) -> Prepared {
        Prepared::new(&self.chi, designs)
    }

    /// W of (14) and its derivatives up to `order`, for each prepared hinge.
    ///
    /// # Panics
    /// If there is not one deformation for each prepared design.
    pub fn evaluate(
        &self,
        prepared: &Prepared,
        deformations: &[HingeDeformation],
        order: Order,
    ) -> Vec<HingeEnergy> {
        energy::evaluate(
            &self.chi,
            self.energy_scale(),
            prepared,
            deformations,
            order,
        )
    }

    /// D and D_peak of (14) and their gradients, for each hinge.
    ///
    /// # Panics
    /// If there is not one deformation for each design.
    pub fn damage(
        &self,
        designs: &[HingeDesign],
        deformations: &[HingeDeformation],
    ) -> Vec<HingeDamage> {
        damage::evaluate(
            &self.chi_d,
            &self.card.damage_scales(),
            designs,
            deformations,
        )
    }
}
