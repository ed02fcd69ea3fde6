//! States on the rays of a campaign, as far as they are needed before the rays are solved.

use fe_driver::{Campaign, Ray};
use hinge::{HingeDeformation, HingeDesign, TrainingDomain};

/// Number of unsolved rays on which one network learns the mean of several, and of states on each of them. In a trial
/// with 100 rays of polypropylene, 300 unsolved rays gave an error of 0.63 % in W, 1000 and 4000 one of 0.50 %.
const TAUGHT_RAYS: usize = 1000;
const TAUGHT_STATES: u32 = 10;

/// States on the rays that follow the first `rays` of the campaign, as far as they are inside the domain.
pub(super) fn unsolved(
    rays: usize,
    campaign: &Campaign,
    domain: &TrainingDomain,
) -> Vec<(HingeDesign, HingeDeformation)> {
    let all = (campaign.rays).rays(&campaign.design, rays + TAUGHT_RAYS, campaign.seed);
    let states = (all.into_iter().skip(rays)).flat_map(|ray| states(ray, TAUGHT_STATES));
    states
        .filter(|(design, state)| domain.contains(design, state))
        .collect()
}

/// States at equal distances on a ray, up to its end.
fn states(ray: Ray, count: u32) -> impl Iterator<Item = (HingeDesign, HingeDeformation)> {
    let (design, end) = (ray.design, ray.end);
    (1..=count).map(move |k| (design, end.at(f64::from(k) / f64::from(count))))
}

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

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn the_taught_states_lie_inside_the_domain_and_on_no_solved_ray() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/campaigns/pet-0.5mm.toml");
        let campaign = Campaign::load(&file).unwrap();
        let domain = region(&campaign).unwrap();
        let solved = (campaign.rays).rays(&campaign.design, 40, campaign.seed);
        let on_solved = |states: &[(HingeDesign, HingeDeformation)]| {
            let mut designs = states.iter().map(|(design, _)| design);
            designs.any(|design| solved.iter().any(|ray| ray.design == *design))
        };
        let whole = unsolved(40, &campaign, &domain);
        // The edges of the domain are rounded, so that few ends of rays lie outside.
        let all = TAUGHT_RAYS * TAUGHT_STATES as usize;
        assert!(whole.len() < all && whole.len() > all * 9 / 10);
        assert!(!on_solved(&whole) && on_solved(&unsolved(0, &campaign, &domain)));

        let smaller = domain.scaled_by(0.5);
        let inner = unsolved(40, &campaign, &smaller);
        assert!(inner.len() > 1000 && inner.len() < whole.len());
        assert!(
            inner
                .iter()
                .all(|(design, state)| smaller.contains(design, state))
        );
    }
}
