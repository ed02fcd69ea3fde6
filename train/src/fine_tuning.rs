//! Pretrained weights as the initial networks of a training on another material, thickness or mesh.
//!
//! The pretrained weights, of the energy W_0, are scaled to the size of the database's windows
//! ([`Surrogate::scaled`]), their first layers to the standardisation of the rows, and the last
//! layer of chi to their root mean square of W. One factor for each of W, D and D_peak is fitted to
//! the rows by least squares:
//!
//! ```text
//! W = c_W W_0,   c_W = sum W* W_0 / sum W_0^2,   and the same for D and D_peak
//! ```
//!
//! Apart from these factors and from rounding, the function of the networks is the function of the
//! pretrained networks.

use crate::affine;
use crate::config::{DAMAGE_SHARPNESS, TrainingConfig};
use crate::networks::{Networks, layers, options};
use crate::samples::Scales;
use crate::validation::Parity;
use burn::tensor::DType;
use dataset::{Manifest, SolvedRay, samples};
use hinge::HingeConstants;
use support::{Fault, ensure, refuse};
use surrogate::{Card, DenseLayer, Layers, Standardisation, Surrogate, feature_names};

/// The initial networks and their scales.
pub(crate) struct Initial {
    pub layers: Layers,
    pub scales: Scales,
}

impl Initial {
    /// The pretrained weights for the windows of a database, fitted to the training rays, which
    /// include their mirror images.
    pub(crate) fn new(
        pretrained: &Surrogate,
        rays: &[SolvedRay],
        manifest: &Manifest,
    ) -> Result<Self, Fault> {
        if pretrained.card().domain.holes.is_some() && manifest.domain.holes.is_none() {
            refuse!(
                "the initial weights are for holes of several radii, but the database has holes of one radius; start with \
                 weights for one radius, or with random weights"
            );
        }
        let pretrained = at_size_of(pretrained, &manifest.hinge);
        let parity = Parity::new(&pretrained, rays);
        let names = feature_names(manifest.domain.holes.is_some());
        let own = Scales::new(rays, manifest.hinge.fillet_ratio, names)?;
        let card = pretrained.card();
        let mut layers = pretrained.layers();
        let (from, to) = (&card.standardisation, &own.standardisation);
        let heads = [Some(&mut layers.chi_d), layers.chi_p.as_mut()];
        for network in heads.into_iter().flatten().chain([&mut layers.chi]) {
            restandardise(&mut network[0], from, to);
        }
        let energy = factor(parity.points(0)) * card.energy_scale / own.energy;
        if let Some(last) = layers.chi.last_mut() {
            multiply(last, energy.sqrt());
        }
        let peak = own.peak.and(card.peak_scale);
        layers.chi_p = layers.chi_p.filter(|_| peak.is_some());
        Ok(Self {
            layers,
            scales: Scales {
                damage: factor(parity.points(4)) * card.damage_scale,
                peak: peak.map(|scale| factor(parity.points(5)) * scale),
                ..own
            },
        })
    }
}

/// The pretrained weights for windows of another size. Campaigns choose the radius of the windows
/// in proportion to the thickness.
fn at_size_of(pretrained: &Surrogate, hinge: &HingeConstants) -> Surrogate {
    let factor = hinge.r_win / pretrained.card().hinge.r_win;
    pretrained.clone().scaled(factor)
}

/// Completes the card of a network that starts from pretrained weights and is trained on `rays`. If
/// all of them are of the law of these weights and in their domain, that domain is kept: the rays
/// they were trained on count as well.
pub(crate) fn inherit(card: &mut Card, pretrained: &Surrogate, rays: &[SolvedRay]) {
    card.fine_tuned_from = Some(pretrained.hash());
    let pretrained = at_size_of(pretrained, &card.hinge);
    let law = &pretrained.card().material_hash;
    let mut states = samples(rays).map(|(ray, sample)| (&ray.design, sample.deformation()));
    let domain = pretrained.domain();
    if law.is_some()
        && *law == card.material_hash
        && states.all(|(design, state)| domain.contains(design, &state))
    {
        card.domain = domain.clone();
    }
}

/// Rejects initial weights whose sizes, sharpness or symmetry differ from the configuration.
pub fn check_pretrained(pretrained: &Surrogate, config: &TrainingConfig) -> Result<(), Fault> {
    let given = pretrained.layers();
    let heads = 1 + usize::from(given.chi_p.is_some());
    let damage = std::iter::repeat_n(config.damage().to_vec(), heads);
    let expected: Vec<_> = std::iter::once(config.embedding.clone()).chain(damage).collect();
    let found = given.widths();
    ensure!(
        found == expected,
        "the initial weights have the layers {found:?}, but the configuration has {expected:?} \
             (embedding and damage heads); change the configuration, or start with random weights"
    );
    let found = pretrained.card().damage_sharpness;
    ensure!(
        found == DAMAGE_SHARPNESS,
        "the initial weights have `damage_sharpness = {found}`, and a training has \
             {DAMAGE_SHARPNESS}; start with random weights"
    );
    let exact = options(DType::F64);
    let folded = Networks::from_layers(&given, &exact);
    let unchanged = layers(&folded)? == given;
    let centred = affine::is_centred(&pretrained.card().standardisation);
    ensure!(
        unchanged && centred,
        "the initial weights do not have the mirror symmetry; start with random weights"
    );
    Ok(())
}

/// The factor of the predictions that is closest to the targets.
fn factor(points: impl Iterator<Item = [f64; 2]>) -> f64 {
    let known: Vec<_> = points.filter(|[target, _]| !target.is_nan()).collect();
    let products = known.iter().map(|[target, predicted]| target * predicted);
    let squares = known.iter().map(|[_, predicted]| predicted.powi(2));
    products.sum::<f64>() / squares.sum::<f64>()
}

/// Changes a first layer such that its outputs for inputs standardised by `to` are those for inputs
/// standardised by `from` before. They do not depend on a feature that only `to` has, the radius
/// of the hole.
fn restandardise(first: &mut DenseLayer, from: &Standardisation, to: &Standardisation) {
    let [known, features] = [from, to].map(|features| features.mean.len());
    let mut weights = Vec::with_capacity(first.bias.values.len() * features);
    let rows = first.weight.values.chunks_exact(known);
    for (row, bias) in rows.zip(&mut first.bias.values) {
        for (k, weight) in row.iter().enumerate() {
            *bias += weight * (to.mean[k] - from.mean[k]) / from.std[k];
            weights.push(weight * to.std[k] / from.std[k]);
        }
        weights.resize(weights.len() + features - known, 0.0);
    }
    first.weight.shape[1] = features;
    first.weight.values = weights;
}

fn multiply(layer: &mut DenseLayer, factor: f64) {
    for values in [&mut layer.weight.values, &mut layer.bias.values] {
        values.iter_mut().for_each(|value| *value *= factor);
    }
}
