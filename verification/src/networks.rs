//! The mesh on which weights are checked.

use crate::verification_error::VerificationError;
use dataset::Fidelity;
use mesher::Tier;
use surrogate::Surrogate;

/// The mesh tier to test weights on: `requested`, or the tier of the database they were trained on,
/// or the finer tier that the database was corrected to.
pub fn verification_tier(
    requested: Option<Tier>,
    surrogate: &Surrogate,
) -> Result<Tier, VerificationError> {
    requested.map_or_else(|| tier_of(&surrogate.card().tier), Ok)
}

fn tier_of(trained_on: &str) -> Result<Tier, VerificationError> {
    let tier = Fidelity::from_tier(trained_on).mesh().parse();
    tier.map_err(|_| VerificationError::NoTier { trained_on: trained_on.to_owned() })
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
