//! The mesh on which weights are checked.

use crate::verification_error::{VerificationError, refused};
use dataset::Fidelity;
use mesher::Tier;
use surrogate::Surrogate;

/// The mesh tier to test weights on: `requested`, or the tier of the database they were trained on,
/// or the finer tier that the database was corrected to.
pub fn verification_tier(
    requested: Option<Tier>,
    surrogate: &Surrogate,
) -> Result<Tier, VerificationError> {
    let trained_on = &surrogate.card().tier;
    let own = || trained_on.parse().map(Fidelity::mesh).ok();
    requested.or_else(own).ok_or_else(|| {
        refused(format!(
            "the weights were trained on the tier `{trained_on}`, which is no mesh tier: pass the \
             tier to compare with as --tier"
        ))
    })
}
