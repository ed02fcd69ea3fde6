//! Confidence intervals of the errors of weights: how much they would differ at other rays.
//!
//! States on one ray have similar errors, so whole rays are drawn with replacement (the cluster
//! bootstrap of Davison and Hinkley, Bootstrap Methods and their Application, 1997, section 3.8).

use crate::validation::Parity;
use dataset::SolvedRay;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use surrogate::Surrogate;

/// Number of draws.
const DRAWS: usize = 1000;
/// The quantiles between which 95 % of the draws lie.
const QUANTILES: [f64; 2] = [0.025, 0.975];
/// W, F_a, F_s and M_theta, in the order of [`dataset::COMPARED`].
const QUANTITIES: usize = 4;

/// A relative root mean square error and its 95 % interval (%).
#[derive(Clone, Copy, Debug, Serialize, derive_more::Display)]
#[display("{error:.2} % (95 % interval {:.2} to {:.2})", interval[0], interval[1])]
pub struct ErrorInterval {
    /// The error of all rays.
    pub error: f64,
    /// The ends of the interval.
    pub interval: [f64; 2],
}

impl ErrorInterval {
    /// Minimum number of rays that predict the errors of other rays.
    pub const LEAST_RAYS: usize = 6;

    /// The errors of W and of the three forces together; `None` below six rays, and if a force is
    /// unknown or zero everywhere.
    pub fn of(surrogate: &Surrogate, rays: &[SolvedRay]) -> Option<[Self; 2]> {
        let sums = |ray: &SolvedRay| {
            let parity = Parity::new(surrogate, std::slice::from_ref(ray));
            std::array::from_fn(|i| {
                parity.points(i).fold([0.0; 2], |[errors, squares], [target, prediction]| {
                    [errors + (prediction - target).powi(2), squares + target * target]
                })
            })
        };
        let rays: Vec<Sums> = rays.iter().map(sums).collect();
        let found = (rays.len() >= Self::LEAST_RAYS).then(|| intervals(&rays))?;
        let is_known = |found: &Self| found.error.is_finite() && found.interval[1].is_finite();
        found.iter().all(is_known).then_some(found)
    }
}

/// Sums of the squares of errors and of targets by quantity.
type Sums = [[f64; 2]; QUANTITIES];

/// Errors of W and of the forces (%) by the sums of rays.
fn errors<'a>(rays: impl Iterator<Item = &'a Sums>) -> [f64; 2] {
    let mut total = Sums::default();
    for ray in rays {
        for (sum, part) in total.as_flattened_mut().iter_mut().zip(ray.as_flattened()) {
            *sum += part;
        }
    }
    let [w, forces @ ..] = total.map(|[errors, squares]| errors / squares);
    [w, forces.iter().sum::<f64>() / 3.0].map(|square| 100.0 * square.sqrt())
}

fn intervals(rays: &[Sums]) -> [ErrorInterval; 2] {
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let draws: Vec<[f64; 2]> = (0..DRAWS)
        .map(|_| errors((0..rays.len()).map(|_| &rays[random.random_range(0..rays.len())])))
        .collect();
    let all = errors(rays.iter());
    [0, 1].map(|i| {
        let mut sorted: Vec<f64> = draws.iter().map(|draw| draw[i]).collect();
        sorted.sort_by(f64::total_cmp);
        ErrorInterval {
            error: all[i],
            interval: QUANTILES.map(|at| sorted[(at * (DRAWS - 1) as f64).round() as usize]),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rays whose squared error of W has a mean of 1e-4, with a scatter.
    fn drawn(count: usize, random: &mut ChaCha8Rng) -> Vec<Sums> {
        let ray = |random: &mut ChaCha8Rng| {
            let share = 2.0 * random.random::<f64>();
            [[1e-4 * share, 1.0]; QUANTITIES]
        };
        (0..count).map(|_| ray(random)).collect()
    }

    #[test]
    fn the_interval_holds_the_true_error_in_nineteen_of_twenty_draws() {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let inside = (0..300)
            .filter(|_| {
                let [w, forces] = intervals(&drawn(30, &mut random));
                assert!((w.error - forces.error).abs() < 1e-12);
                let [low, high] = w.interval;
                (low..=high).contains(&1.0)
            })
            .count();
        // Three standard deviations; a bootstrap of 30 rays is a little narrow.
        assert!((265..=297).contains(&inside), "{inside} of 300");
    }

    #[test]
    fn equal_rays_have_no_interval_and_more_rays_a_narrower_one() {
        let [w, _] = intervals(&[[[4e-4, 1.0]; QUANTITIES]; 5]);
        assert_eq!(w.interval, [w.error; 2]);
        assert!((w.error - 2.0).abs() < 1e-12);
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let [few, many] = [10, 160].map(|count| {
            let [w, _] = intervals(&drawn(count, &mut random));
            (w.interval[1] - w.interval[0]) / w.error
        });
        let ratio = few / many;
        assert!((2.5..6.0).contains(&ratio), "{ratio}");
    }
}
