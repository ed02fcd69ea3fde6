//! Why the hinge law of a scene cannot be used.

use crate::equilibrium::tangent::MIN_PIVOT_RATIO;
use crate::hinge_law::InvalidContact;
use std::path::PathBuf;

/// A hinge law without what it needs, or one that the rest of the scene excludes; the message names the key.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum InvalidHinge {
    #[error("hinge = \"{0}\" needs the section [{0}]")]
    NoSection(&'static str),
    #[error(
        "{section}.weights: there is no file {}: train it, or give the constants of hinge = \"linear\"",
        file.display()
    )]
    NoWeights {
        section: &'static str,
        file: PathBuf,
    },
    #[error("the weights {} are for {source}", file.display())]
    OtherHinges {
        file: PathBuf,
        source: WeightsMismatch,
    },
    #[error("surrogate.ensemble: all networks must be trained on the data of surrogate.weights")]
    OtherTraining,
    #[error(
        "condensed: at w_lig = {w_lig} mm the weights have k_a = {} N/mm, k_s = {} N/mm, k_theta = {} N mm, which must \
         all be positive: use hinge = \"surrogate\" or other weights",
        constants[0], constants[1], constants[2]
    )]
    Condensed { w_lig: f64, constants: [f64; 3] },
    #[error(
        "linear.k_theta is {ratio:.0e} times the greater of linear.k_a and linear.k_s times the area of a panel: below \
         {MIN_PIVOT_RATIO:.0e} rotations are lost in the rounding of the translations. Raise k_theta, or lower k_a and k_s"
    )]
    Soft { ratio: f64 },
    #[error(transparent)]
    Contact(#[from] InvalidContact),
    #[error(
        "supports, loads, edge_loads, opening_couples, drive, contact: hinge = \"pin\" has no equilibrium: remove these \
         sections, or use hinge = \"linear\""
    )]
    HeldPins,
    #[error("objective.domain needs hinge = \"surrogate\": no other law has a domain")]
    NoDomain,
    #[error(
        "objective.damage_measure = \"peak\": the weights do not predict D_peak: use \"mean\", or train on a database \
         that contains it"
    )]
    NoPeakDamage,
    #[error(
        "objective.damage: only the learned hinge law predicts damage: use hinge = \"surrogate\" or damage = 0"
    )]
    NoDamage,
}

/// What weights are for, if not for the hinges of the scene.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum WeightsMismatch {
    #[error(
        "another material law than that of the scene: `{trained}` ({trained_law}, that of the file `{file}` is {law}). Name \
         the material file of the training, with its thickness; the key `thickness` of the scene gives that of the sheet. \
         If its numbers have changed, train again"
    )]
    Law {
        trained: String,
        trained_law: String,
        file: String,
        law: String,
    },
    #[error("the material `{trained}`, the scene's is `{file}`")]
    Material { trained: String, file: String },
    #[error("fillet_ratio = {trained}, but the scene has process.fillet_ratio = {scene}")]
    FilletRatio { trained: f64, scene: f64 },
    #[error(
        "windows of r_win = {trained} mm in a sheet of this thickness, but the scene has process.r_win = {scene}"
    )]
    Window { trained: f64, scene: f64 },
}
