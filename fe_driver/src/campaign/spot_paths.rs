//! States drawn uniformly inside a domain, on random rays.
//!
//! The training domain contains the flat state, and in its coordinates the straight line from there
//! to a state inside, which the rays of the training follow. Draw a state x uniformly inside it; x
//! fixes a direction with the density of uniform states. With R the distance to the boundary along
//! it and u uniform in (0, 1), the state at the distance R u^(1/3) is again uniform. Several states
//! can therefore lie on one ray.

use crate::{Campaign, HingePath, Ray, RayBox};
use hinge::{HingeConstants, Regime, TrainingDomain};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A hinge driven along a path, and the fractions of the path at which weights are compared with
/// it.
#[derive(Debug, PartialEq)]
pub struct SpotPath {
    /// The hinge and its path.
    pub hinge: HingePath,
    /// Fractions of the path, in (0, 1].
    pub fractions: Vec<f64>,
}

/// The hinges and states that are drawn.
#[derive(Clone, Copy, Debug)]
pub struct DrawnStates<'a> {
    /// Widths, cut angles, holes if they have several radii, and deformations.
    pub domain: &'a TrainingDomain,
    /// Kerf, window and, unless several are in the domain, the hole.
    pub constants: &'a HingeConstants,
    /// How rays are driven.
    pub regime: Regime,
}

/// Number of states on a ray of the spot check: more need fewer solves but cover fewer hinges.
pub(crate) const STATES_PER_RAY: usize = 4;
/// Seed of the spot check.
const SPOT_SEED: u64 = 5;

impl Campaign {
    /// The states that the rays pass through if they are solved to their ends. They do not depend
    /// on the number of rays, so that the spot check remains the same when the campaign is
    /// enlarged. `None` if no ray passes through a state.
    pub fn region(&self) -> Option<TrainingDomain> {
        const RAYS: usize = 1500;
        const STATES: u32 = 10;
        let regime = self.tier.regime();
        let of_box = |rays: &RayBox| rays.rays(&self.design, regime, RAYS);
        let rays = self.boxes.iter().flat_map(of_box);
        let rays = rays.flat_map(|ray| [ray, ray.mirrored()]);
        let states = rays.flat_map(|ray| {
            let HingePath { design, path } = ray.driven(regime);
            (1..=STATES).map(move |k| (design, path.at(f64::from(k) / f64::from(STATES))))
        });
        TrainingDomain::covering(states.collect::<Vec<_>>())
    }

    /// The states of its region.
    pub fn drawn<'a>(&'a self, region: &'a TrainingDomain) -> DrawnStates<'a> {
        DrawnStates { domain: region, constants: &self.design, regime: self.tier.regime() }
    }

    /// The paths of the spot check.
    pub fn spot_paths(&self) -> Vec<SpotPath> {
        let region = (self.spot_rays > 0).then(|| self.region()).flatten();
        match region {
            Some(region) => {
                let states = STATES_PER_RAY * self.spot_rays;
                random_paths(self.drawn(&region), states, STATES_PER_RAY, SPOT_SEED)
            }
            None => Vec::new(),
        }
    }
}

/// `count` states drawn uniformly, `each` of them on one ray.
pub fn random_paths(drawn: DrawnStates, count: usize, each: usize, seed: u64) -> Vec<SpotPath> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut paths = Vec::new();
    let mut left = count;
    while left > 0 {
        let states = each.min(left);
        paths.push(random_path(drawn, states, &mut random));
        left -= states;
    }
    paths
}

/// A random ray inside the training domain with `states` uniformly distributed states on it.
fn random_path(drawn: DrawnStates, states: usize, random: &mut ChaCha8Rng) -> SpotPath {
    let domain = drawn.domain;
    let mut between = |[from, to]: [f64; 2]| from + (to - from) * random.random::<f64>();
    let mut design =
        drawn.constants.hinge(between(domain.w_lig.map(f64::ln)).exp(), between(domain.alpha));
    if let Some(holes) = domain.holes {
        design.fillet_ratio = between(holes);
    }
    let bounds = domain.bounds();
    let direction = loop {
        let state = domain.state(&design, bounds.map(&mut between));
        if domain.contains(&design, &state) {
            break state;
        }
    };
    let direction = domain.coordinates(&design, &direction);
    let at = |factor: f64| domain.state(&design, direction.map(|x| factor * x));
    let edge = edge(|factor| domain.contains(&design, &at(factor)));
    let mut radii: Vec<f64> = (0..states).map(|_| between([0.0, 1.0]).cbrt()).collect();
    radii.sort_by(f64::total_cmp);
    let outermost = radii[states - 1];
    let end = at(edge * outermost);
    SpotPath {
        hinge: Ray { design, end }.driven(drawn.regime),
        fractions: radii.iter().map(|radius| radius / outermost).collect(),
    }
}

/// The largest factor that is inside.
fn edge(inside: impl Fn(f64) -> bool) -> f64 {
    let mut outside = 2.0;
    while inside(outside) {
        outside *= 2.0;
    }
    let mut edge = 0.5 * outside;
    for _ in 0..40 {
        let middle = 0.5 * (edge + outside);
        if inside(middle) {
            edge = middle;
        } else {
            outside = middle;
        }
    }
    edge
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_are_uniform_inside_the_domain() {
        let state = [[-0.8, 0.2], [-0.4, 0.4], [-0.1, 1.3]];
        let mut domain = testkit::domain_of_box(state, [5.0, 25.0], [0.8, 2.3]);
        domain.holes = Some([0.1, 0.3]);
        let drawn = DrawnStates {
            domain: &domain,
            constants: &HingeConstants::PAPER,
            regime: Regime::Film,
        };
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut counts = [0; 5];
        let mut all = 0;
        for _ in 0..500 {
            let spot = random_path(drawn, 4, &mut random);
            assert_eq!(spot.fractions.last(), Some(&1.0));
            for fraction in &spot.fractions {
                let state = spot.hinge.path.at(*fraction);
                assert!(domain.contains(&spot.hinge.design, &state));
                let [eta_a, eta_s, _] = domain.coordinates(&spot.hinge.design, &state);
                // Counts in halves of the domain.
                counts[0] += usize::from(eta_a > -0.3);
                counts[1] += usize::from(eta_s > 0.0);
                counts[2] += usize::from(state.theta > 0.6);
                counts[3] += usize::from(spot.hinge.design.w_lig > 125f64.sqrt());
                counts[4] += usize::from(spot.hinge.design.fillet_ratio > 0.2);
                all += 1;
            }
        }
        for count in counts {
            let fraction = f64::from(u32::try_from(count).unwrap()) / f64::from(all);
            // Four standard deviations of 500 independent rays.
            assert!((fraction - 0.5).abs() < 0.09, "{fraction}");
        }
    }
}
