//! The condensed hinge energy (14): a learned potential of the hinge deformation.
//!
//! ```text
//! W(eps; g) = W_s |chi(xi(eps, g)) - chi(xi(0, g))|^2
//! D(eps; g) = D_s softplus(beta chi_D(xi(eps, g))) / beta,   and D_peak likewise with chi_P
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

/// The networks of (14) with everything needed to evaluate and to describe them.
#[derive(Clone, Debug)]
pub struct Surrogate {
    /// The embedding chi, of any number of outputs.
    chi: Network,
    /// The damage head chi_D, of one output.
    chi_d: Network,
    /// The same of D_peak, where the card has a scale for it.
    chi_p: Option<Network>,
    card: Card,
}

/// The networks of a surrogate as weight files hold them, each from its first layer to its last.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    /// The embedding chi.
    pub chi: Vec<Layer>,
    /// The damage head chi_D.
    pub chi_d: Vec<Layer>,
    /// The head of D_peak.
    pub chi_p: Option<Vec<Layer>>,
}

impl Surrogate {
    /// Joins networks and card.
    ///
    /// The networks take the standardised features; each head has one output, and there is one of
    /// D_peak if the card has a scale for it.
    pub fn from_parts(layers: Layers, card: Card) -> Result<Self, InvalidWeights> {
        card.validate()?;
        let Layers { chi, chi_d, chi_p } = layers;
        let network =
            |name, layers, outputs| Network::new(name, layers, outputs, &card.standardisation);
        let chi = network("chi", chi, None)?;
        let chi_d = network("chi_d", chi_d, Some(1))?;
        let chi_p = match (chi_p, card.peak_scale) {
            (None, None) => None,
            (layers, Some(_)) => Some(network("chi_p", layers.unwrap_or_default(), Some(1))?),
            (Some(_), None) => {
                return Err(InvalidWeights::Missing {
                    tensor: "d_scale of chi_p".into(),
                });
            }
        };
        Ok(Self {
            chi,
            chi_d,
            chi_p,
            card,
        })
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

    /// The networks as they are written.
    pub fn layers(&self) -> Layers {
        let layers = |network: &Network| network.layers().to_vec();
        Layers {
            chi: layers(&self.chi),
            chi_d: layers(&self.chi_d),
            chi_p: self.chi_p.as_ref().map(layers),
        }
    }

    /// The hinge states that the training data fill.
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
        assert_eq!(
            designs.len(),
            deformations.len(),
            "one deformation for each hinge"
        );
        let sharpness = self.card.damage_sharpness;
        let evaluate =
            |head, scale| damage::evaluate(head, scale, sharpness, designs, deformations);
        let averages = evaluate(&self.chi_d, self.card.damage_scale).into_iter();
        let mut damages: Vec<HingeDamage> = averages
            .map(|(d, gradient)| HingeDamage {
                d,
                gradient,
                ..HingeDamage::default()
            })
            .collect();
        if let (Some(chi_p), Some(scale)) = (&self.chi_p, self.card.peak_scale) {
            for (damage, (peak, gradient)) in damages.iter_mut().zip(evaluate(chi_p, scale)) {
                (damage.d_peak, damage.peak_gradient) = (Some(peak), gradient);
            }
        }
        damages
    }
}
