//! The networks that are judged, and the mesh that judges them.

use crate::verification_error::VerificationError;
use dataset::Fidelity;
use design::scene::Scene;
use mesher::Tier;
use std::path::PathBuf;
use surrogate::Surrogate;

/// The other networks of an ensemble with the scene's `surrogate`, whose spread estimates its error: `files`, trained on
/// the same data, or those that the scene names.
pub fn ensemble(
    scene: &Scene,
    surrogate: &Surrogate,
    files: &[PathBuf],
) -> Result<Vec<Surrogate>, VerificationError> {
    if files.is_empty() {
        return Ok(scene.networks().iter().skip(1).cloned().collect());
    }
    let load = |path: &PathBuf| {
        let network = scene.network(path)?;
        let (own, other) = (surrogate.card(), network.card());
        if own.dataset_hash != other.dataset_hash || own.split_hash != other.split_hash {
            return Err(VerificationError::OtherData(path.clone()));
        }
        Ok(network)
    };
    files.iter().map(load).collect()
}

/// The mesh tier to test weights on: `requested`, or that of the database they were trained on, or the finer tier
/// that the database was corrected to.
pub fn judging_tier(
    requested: Option<Tier>,
    surrogate: &Surrogate,
) -> Result<Tier, VerificationError> {
    requested.map_or_else(|| tier_of(&surrogate.card().tier), Ok)
}

fn tier_of(trained_on: &str) -> Result<Tier, VerificationError> {
    let tier = Fidelity::from_tier(trained_on).mesh().parse();
    tier.map_err(|_| VerificationError::NoTier {
        trained_on: trained_on.to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_judged_by_the_mesh_they_were_trained_on() {
        assert_eq!(tier_of("tiny").unwrap(), Tier::Tiny);
        let corrected = tier_of("default corrected to reference");
        assert_eq!(corrected.unwrap(), Tier::Reference);
        for unclear in ["default + tiny", "another solver", ""] {
            let message = tier_of(unclear).unwrap_err().to_string();
            assert!(message.contains("--tier"), "{message}");
        }
    }
}
