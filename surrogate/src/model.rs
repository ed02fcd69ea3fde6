//! A surrogate: the networks of (14) with their card.

use crate::card::{Card, SpotCheck, TestErrors};
use crate::damage::{self, HingeDamage};
use crate::energy::{self, Prepared};
use crate::features::{HingeEnergy, Order};
use crate::network::{DenseLayer, Network, missing};
use crate::reference_ligament;
use hinge::{
    HingeDeformation, HingeDesign, HingeSample, NetLigament, Regime, SheetMaterial, TrainingDomain,
};
use support::Fault;

/// The networks of (14), with the card that contains their scaling and provenance.
#[derive(Clone, Debug)]
pub struct Surrogate {
    /// The embedding chi, with any number of outputs.
    chi: Network,
    /// The damage head chi_D, with one output.
    chi_d: Network,
    /// The head of D_peak, with one output; it exists if the card has a scale for it.
    chi_p: Option<Network>,
    card: Card,
}

/// The networks of a surrogate as in a weight file, each from its first layer to its last.
#[derive(Debug, PartialEq)]
pub struct Layers {
    /// The embedding chi.
    pub chi: Vec<DenseLayer>,
    /// The damage head chi_D.
    pub chi_d: Vec<DenseLayer>,
    /// The head of D_peak.
    pub chi_p: Option<Vec<DenseLayer>>,
}

impl Layers {
    /// Number of units of each layer: of chi, and of the hidden layers of each damage head.
    pub fn widths(&self) -> Vec<Vec<usize>> {
        let units = |layers: &[DenseLayer]| -> Vec<usize> {
            layers.iter().map(|layer| layer.bias.values.len()).collect()
        };
        let heads = std::iter::once(&self.chi_d).chain(&self.chi_p);
        let hidden = heads.map(|head| units(&head[..head.len().saturating_sub(1)]));
        std::iter::once(units(&self.chi)).chain(hidden).collect()
    }
}

impl Surrogate {
    /// Constructs a surrogate from its networks and its card.
    ///
    /// The input of the networks is the standardised features. Each head has one output. There must
    /// be a head of D_peak if, and only if, the card has a scale for it.
    pub fn from_parts(layers: Layers, card: Card) -> Result<Self, Fault> {
        card.validate()?;
        let Layers { chi, chi_d, chi_p } = layers;
        let network =
            |name, layers, outputs| Network::new(name, layers, outputs, &card.standardisation);
        let chi = network("chi", chi, None)?;
        let chi_d = network("chi_d", chi_d, Some(1))?;
        let chi_p = match (chi_p, card.peak_scale) {
            (None, None) => None,
            (layers, Some(_)) => Some(network("chi_p", layers.unwrap_or_default(), Some(1))?),
            (Some(_), None) => return Err(missing("d_scale of chi_p")),
        };
        Ok(Self { chi, chi_d, chi_p, card })
    }

    /// The same surrogate with test errors on its card; they can only be measured with the
    /// surrogate.
    pub fn with_test_errors(mut self, test_errors: TestErrors) -> Self {
        self.card.test_errors = test_errors;
        self
    }

    /// The same surrogate with a spot check on its card.
    pub fn with_spot_check(mut self, check: SpotCheck) -> Self {
        self.card.spot_check = Some(check);
        self
    }

    /// The same surrogate with its errors where designed sheets go on its card.
    pub fn with_visited(mut self, check: SpotCheck) -> Self {
        self.card.visited = Some(check);
        self
    }

    /// The surrogate of the same material at `factor` times the thickness, exact for geometrically
    /// similar hinges.
    ///
    /// The window is rate-independent and has no length of its own, so with all lengths
    /// multiplied by `factor`, W is multiplied by its cube, and D and D_peak do not change. A hinge
    /// of width w_lig therefore has `factor`^3 times the energy of the hinge w_lig / `factor` of
    /// this surrogate, at the same (eta_a, eta_s, theta).
    ///
    /// # Panics
    /// If `factor` is not positive and finite.
    pub fn scaled(self, factor: f64) -> Self {
        assert!(factor > 0.0 && factor.is_finite(), "the ratio of two thicknesses is positive");
        let layers = self.layers();
        Self::from_parts(layers, self.card.scaled(factor))
            .expect("layers and scales were valid before")
    }

    /// The surrogate of a material with `factor` times the stress at every strain: energies and
    /// forces are multiplied by it. Its card names that `material`, or none.
    ///
    /// # Panics
    /// If `factor` is not positive and finite.
    pub fn stressed(mut self, factor: f64, material: Option<&SheetMaterial>) -> Self {
        assert!(factor > 0.0 && factor.is_finite(), "the ratio of two stresses is positive");
        self.card.energy_scale *= factor;
        self.card.material_hash = material.map(SheetMaterial::law_hash);
        self
    }

    /// The metadata: training data, scaling, test errors.
    pub fn card(&self) -> &Card {
        &self.card
    }

    /// The layers of the networks as in the weight file.
    pub fn layers(&self) -> Layers {
        let layers = |network: &Network| network.layers().to_vec();
        Layers {
            chi: layers(&self.chi),
            chi_d: layers(&self.chi_d),
            chi_p: self.chi_p.as_ref().map(layers),
        }
    }

    /// BLAKE3 hash (hexadecimal) of everything that predictions depend on: networks, scales,
    /// domain, hinge constants.
    pub fn hash(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        let networks = [Some(&self.chi), Some(&self.chi_d), self.chi_p.as_ref()];
        for layer in networks.into_iter().flatten().flat_map(Network::layers) {
            for tensor in [&layer.weight, &layer.bias] {
                for value in &tensor.values {
                    hasher.update(&value.to_le_bytes());
                }
            }
        }
        let Card {
            standardisation,
            energy_scale,
            damage_scale,
            peak_scale,
            damage_sharpness,
            domain,
            hinge,
            ..
        } = &self.card;
        let scales = (energy_scale, damage_scale, peak_scale, damage_sharpness);
        let evaluated = serde_json::to_vec(&(standardisation, scales, domain, hinge));
        hasher.update(&evaluated.expect("these are numbers and text"));
        hasher.finalize().to_hex().to_string()
    }

    /// The hinge states that the training data cover.
    pub fn domain(&self) -> &TrainingDomain {
        &self.card.domain
    }

    /// How the rays bend along which the training data were solved: at the rotation lambda theta,
    /// eta_a is this times theta |theta| lambda (1 - lambda) below the straight line to its end. 0:
    /// rays are straight.
    pub fn ray_curvature(&self) -> f64 {
        let [_, of_free_turn] = Regime::Plate.free_opening();
        if self.card.bent_rays { of_free_turn } else { 0.0 }
    }

    /// Minimum and maximum radius of the holes of the training, over w_lig.
    pub fn holes(&self) -> [f64; 2] {
        (self.card.domain.holes).unwrap_or([self.card.hinge.fillet_ratio; 2])
    }

    /// Whether a state lies inside the training domain, and the hole of its hinge among the holes
    /// of the training.
    pub fn contains(&self, design: &HingeDesign, deformation: &HingeDeformation) -> bool {
        let [least, most] = self.holes();
        (least..=most).contains(&design.fillet_ratio)
            && self.card.domain.contains(design, deformation)
    }

    /// W_s of (14): the root mean square of the training energies (N mm).
    pub fn energy_scale(&self) -> f64 {
        self.card.energy_scale
    }

    /// D_s of (14): the root mean square of the training damage.
    pub fn damage_scale(&self) -> f64 {
        self.card.damage_scale
    }

    /// Computes the quantities that depend only on the designs: chi(xi(0, g)) and its derivative
    /// in g.
    pub fn prepare(&self, designs: &[HingeDesign]) -> Prepared {
        Prepared::new(&self.chi, designs, self.card.hinge.fillet_ratio)
    }

    /// W of (14) and its derivatives up to `order`, for each prepared hinge.
    ///
    /// # Panics
    /// If the numbers of prepared designs and of deformations differ.
    pub fn evaluate(
        &self,
        prepared: &Prepared,
        deformations: &[HingeDeformation],
        order: Order,
    ) -> Vec<HingeEnergy> {
        energy::evaluate(&self.chi, self.energy_scale(), prepared, deformations, order)
    }

    /// The hinge deformation with W and the forces (14), D and D_peak, for each hinge. The other
    /// quantities of the samples are zero.
    ///
    /// # Panics
    /// If the numbers of designs and of deformations differ.
    pub fn samples(
        &self,
        designs: &[HingeDesign],
        deformations: &[HingeDeformation],
    ) -> Vec<HingeSample> {
        let energies = self.evaluate(&self.prepare(designs), deformations, Order::Forces);
        let damages = self.damage(designs, deformations, false);
        (deformations.iter().zip(energies).zip(damages))
            .map(|((deformation, energy), damage)| {
                let [a, s, theta] = deformation.to_array();
                let [f_a, f_s, m_theta] = energy.forces;
                HingeSample {
                    a,
                    s,
                    theta,
                    w: energy.w,
                    f_a,
                    f_s,
                    m_theta,
                    d: damage.d,
                    d_peak: damage.d_peak,
                    ..HingeSample::default()
                }
            })
            .collect()
    }

    /// D and D_peak of (14) for each hinge, with their gradients or only by a forward pass: the
    /// gradients are zero then.
    ///
    /// # Panics
    /// If the numbers of designs and of deformations differ.
    pub fn damage(
        &self,
        designs: &[HingeDesign],
        deformations: &[HingeDeformation],
        with_gradient: bool,
    ) -> Vec<HingeDamage> {
        assert_eq!(designs.len(), deformations.len(), "one deformation for each hinge");
        let seen: Vec<_> = std::iter::zip(designs, deformations)
            .map(|(design, deformation)| {
                let ligament = NetLigament::new(design, self.card.hinge.fillet_ratio);
                let (design, deformation) =
                    reference_ligament::seen(&ligament, design, deformation);
                (ligament, design, deformation)
            })
            .collect();
        let sharpness = self.card.damage_sharpness;
        let evaluate = |head, scale| damage::evaluate(head, scale, sharpness, &seen, with_gradient);
        let averages = evaluate(&self.chi_d, self.card.damage_scale).into_iter();
        let mut damages: Vec<HingeDamage> = averages
            .map(|(d, gradient)| HingeDamage { d, gradient, ..HingeDamage::default() })
            .collect();
        if let (Some(chi_p), Some(scale)) = (&self.chi_p, self.card.peak_scale) {
            for (damage, (peak, gradient)) in damages.iter_mut().zip(evaluate(chi_p, scale)) {
                (damage.d_peak, damage.peak_gradient) = (Some(peak), gradient);
            }
        }
        damages
    }
}
