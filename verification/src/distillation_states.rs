//! Random states at which one network learns from several.

use fe_driver::{DrawnStates, SpotPath, random_paths};
use hinge::{HingeDeformation, HingeDesign};

/// Number of states of the distillation. With 10 000 the errors of steel at two spot checks are a
/// tenth to a third larger.
const DISTILLATION_STATES: usize = 20_000;

/// The states at which one network learns the median of several, drawn uniformly inside the region.
/// If they lie only on rays of the campaign, the network is free in the corners that no ray
/// passes: the moment of one such network of steel was wrong by 27 times the root mean square
/// there, although the moments of the several networks were not (docs/TRIED.md). Some states lie
/// outside the training domain of the solved rays: the networks extrapolate there, and the one
/// network follows their median.
pub fn distillation_states(drawn: DrawnStates) -> Vec<(HingeDesign, HingeDeformation)> {
    // Other states than the states of a spot check, whose seeds are small by habit.
    const SEED: u64 = u64::MAX;
    let paths = random_paths(drawn, DISTILLATION_STATES, 1, SEED);
    let state = |path: &SpotPath| (path.hinge.design, path.hinge.path.at(1.0));
    paths.iter().map(state).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fe_driver::Campaign;
    use std::path::Path;

    #[test]
    fn the_states_of_a_distillation_fill_the_region() {
        let file =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/campaigns/pet-0.5mm.toml");
        let campaign = Campaign::load(&file).unwrap();
        let region = campaign.region().unwrap();
        let states = distillation_states(DrawnStates {
            domain: &region,
            constants: &campaign.design,
            regime: campaign.tier.regime(),
        });
        assert_eq!(states.len(), DISTILLATION_STATES);
        assert!(states.iter().all(|(design, state)| region.contains(design, state)));
        // Uniform in three dimensions: half of the states are in the outer fifth of their rays.
        let outer = |(design, state): &&(HingeDesign, HingeDeformation)| {
            !region.contains(design, &state.at(0.5f64.cbrt().recip()))
        };
        let outer = states.iter().filter(outer).count();
        let deviation = outer.abs_diff(states.len() / 2);
        assert!(deviation < states.len() / 50, "{outer}");
    }
}
