//! The region of states that the rays of a campaign cover, as far as it is needed before they are solved.

use crate::replays::spot_states;
use fe_driver::{Campaign, Ray};
use hinge::{HingeConstants, HingeDeformation, HingeDesign, TrainingDomain};

/// The states that the campaign's rays pass through if they are solved to their ends. It does not depend on the number of
/// rays, so that the spot check remains the same when the campaign is enlarged.
pub(super) fn region(campaign: &Campaign) -> Option<TrainingDomain> {
    const RAYS: usize = 1500;
    const STATES: u32 = 10;
    let rays = (campaign.rays).rays(&campaign.design, RAYS, campaign.seed);
    let rays = rays.into_iter().flat_map(|ray| [ray, ray.mirrored()]);
    let states: Vec<_> = rays.flat_map(|ray| states(ray, STATES)).collect();
    TrainingDomain::covering(states)
}

/// States at equal distances on a ray, up to its end.
fn states(ray: Ray, count: u32) -> impl Iterator<Item = (HingeDesign, HingeDeformation)> {
    let (design, end) = (ray.design, ray.end);
    (1..=count).map(move |k| (design, end.at(f64::from(k) / f64::from(count))))
}

/// Number of states of the distillation. With 10 000 the errors of steel at two spot checks are a tenth to a third larger.
const TAUGHT: usize = 20_000;

/// The states at which one network learns the median of several, drawn uniformly inside the region. If they lie on rays of
/// the campaign alone, the network is free in the corners that no ray passes: the moment of one of steel was wrong by 27 times
/// the root mean square there, although those of its teachers were not (`docs/results/fine-tuning`). Some states lie outside
/// the training domain of the solved rays: the teachers extrapolate there, and the network follows their median.
pub(super) fn taught(
    region: &TrainingDomain,
    constants: &HingeConstants,
) -> Vec<(HingeDesign, HingeDeformation)> {
    // Other states than those of a spot check, whose seeds are small by habit.
    const SEED: u64 = u64::MAX;
    let probes = spot_states::drawn(region, constants, TAUGHT, 1, SEED);
    probes
        .iter()
        .map(|probe| (probe.design, probe.path.at(1.0)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn the_taught_states_fill_the_region() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/campaigns/pet-0.5mm.toml");
        let campaign = Campaign::load(&file).unwrap();
        let region = region(&campaign).unwrap();
        let taught = taught(&region, &campaign.design);
        assert_eq!(taught.len(), TAUGHT);
        assert!(
            taught
                .iter()
                .all(|(design, state)| region.contains(design, state))
        );
        // Uniform in three dimensions: half of the states are in the outer fifth of their rays.
        let outer = |(design, state): &&(HingeDesign, HingeDeformation)| {
            !region.contains(design, &state.at(0.5f64.cbrt().recip()))
        };
        let outer = taught.iter().filter(outer).count();
        let deviation = outer.abs_diff(taught.len() / 2);
        assert!(deviation < taught.len() / 50, "{outer}");
    }
}
