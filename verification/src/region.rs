//! The region of states that the rays of a campaign cover, as far as it is needed before they are solved.

use crate::spot_check::{DrawnStates, SpotPath, random_paths};
use fe_driver::{Campaign, Ray};
use hinge::{HingeDeformation, HingeDesign, TrainingDomain};

/// The states that the campaign's rays pass through if they are solved to their ends. It does not depend on the number of
/// rays, so that the spot check remains the same when the campaign is enlarged.
pub fn region(campaign: &Campaign) -> Option<TrainingDomain> {
    const RAYS: usize = 1500;
    const STATES: u32 = 10;
    let rays = (campaign.rays).rays(&campaign.design, RAYS, campaign.seed);
    let rays = rays.into_iter().flat_map(|ray| [ray, ray.mirrored()]);
    let states: Vec<_> = rays.flat_map(|ray| states(ray, STATES)).collect();
    TrainingDomain::covering(states)
}

/// The states of a campaign's region.
pub fn drawn<'a>(campaign: &'a Campaign, region: &'a TrainingDomain) -> DrawnStates<'a> {
    DrawnStates {
        domain: region,
        constants: &campaign.design,
    }
}

/// States at equal distances on a ray, up to its end.
fn states(ray: Ray, count: u32) -> impl Iterator<Item = (HingeDesign, HingeDeformation)> {
    let (design, end) = (ray.design, ray.end);
    (1..=count).map(move |k| (design, end.at(f64::from(k) / f64::from(count))))
}

/// Number of states of the distillation. With 10 000 the errors of steel at two spot checks are a tenth to a third larger.
const DISTILLATION_STATES: usize = 20_000;

/// The states at which one network learns the median of several, drawn uniformly inside the region. If they lie on rays of
/// the campaign alone, the network is free in the corners that no ray passes: the moment of one of steel was wrong by 27 times
/// the root mean square there, although those of the networks were not (docs/TRIED.md). Some states lie outside
/// the training domain of the solved rays: the networks extrapolate there, and the one network follows their median.
pub fn distillation_states(drawn: DrawnStates) -> Vec<(HingeDesign, HingeDeformation)> {
    // Other states than those of a spot check, whose seeds are small by habit.
    const SEED: u64 = u64::MAX;
    let paths = random_paths(drawn, DISTILLATION_STATES, 1, SEED);
    let state = |path: &SpotPath| (path.hinge.design, path.hinge.path.at(1.0));
    paths.iter().map(state).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn the_states_of_a_distillation_fill_the_region() {
        let file =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/campaigns/pet-0.5mm.toml");
        let campaign = Campaign::load(&file).unwrap();
        let region = region(&campaign).unwrap();
        let states = distillation_states(drawn(&campaign, &region));
        assert_eq!(states.len(), DISTILLATION_STATES);
        assert!(
            states
                .iter()
                .all(|(design, state)| region.contains(design, state))
        );
        // Uniform in three dimensions: half of the states are in the outer fifth of their rays.
        let outer = |(design, state): &&(HingeDesign, HingeDeformation)| {
            !region.contains(design, &state.at(0.5f64.cbrt().recip()))
        };
        let outer = states.iter().filter(outer).count();
        let deviation = outer.abs_diff(states.len() / 2);
        assert!(deviation < states.len() / 50, "{outer}");
    }
}
