//! Rays for hinges of a sheet at states that the training data does not cover.

use crate::recorded_path::RecordedPath;
use fe_driver::Ray;
use hinge::HingeDeformation;
use surrogate::{Order, Surrogate, mean_and_variance};

/// Rays through states of the hinges of a sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct PathRays {
    /// One ray for every hinge that is counted below.
    pub rays: Vec<Ray>,
    /// Number of hinges that leave the training domain.
    pub outside: usize,
    /// Number of the other hinges whose forces the networks doubt.
    pub doubted: usize,
}

/// A ray for every hinge that leaves the training domain on its path, or whose forces have a standard deviation over
/// `networks` above `doubt` times their root mean square. It leads through the outermost such state, to `beyond` times it.
pub fn rays_on_paths(
    paths: &[RecordedPath],
    networks: &[Surrogate],
    doubt: f64,
    beyond: f64,
) -> PathRays {
    let domain = networks[0].domain();
    let mut found = PathRays {
        rays: Vec::new(),
        outside: 0,
        doubted: 0,
    };
    for (path, own_doubt) in paths.iter().zip(doubts(networks, paths)) {
        let leaves = |state: &&HingeDeformation| !domain.contains(&path.design, state);
        let left: Vec<_> = path.states.iter().filter(leaves).copied().collect();
        let through = if !left.is_empty() {
            found.outside += 1;
            furthest(&left, path.design.w_lig)
        } else if own_doubt > doubt {
            found.doubted += 1;
            furthest(&path.states, path.design.w_lig)
        } else {
            continue;
        };
        found.rays.push(Ray {
            design: path.design,
            end: through.at(beyond),
        });
    }
    found
}

/// The state that is furthest from the undeformed one.
fn furthest(states: &[HingeDeformation], w_lig: f64) -> HingeDeformation {
    let size = |state: &HingeDeformation| {
        let [eta_a, eta_s] = state.eta(w_lig);
        eta_a * eta_a + eta_s * eta_s + state.theta * state.theta
    };
    let furthest = states.iter().max_by(|x, y| size(x).total_cmp(&size(y)));
    furthest.copied().unwrap_or_default()
}

/// For each path, the maximum standard deviation of (w_lig F_a, w_lig F_s, M) over the networks,
/// relative to the root mean square of all; zero with one network.
fn doubts(networks: &[Surrogate], paths: &[RecordedPath]) -> Vec<f64> {
    let (mut squares, mut count) = (0.0, 0.0);
    let deviations: Vec<f64> = paths
        .iter()
        .map(|path| {
            let designs = vec![path.design; path.states.len()];
            let w_lig = path.design.w_lig;
            let forces: Vec<Vec<[f64; 3]>> = networks
                .iter()
                .map(|network| {
                    let prepared = network.prepare(&designs);
                    let energies = network.evaluate(&prepared, &path.states, Order::Forces);
                    let moments = energies.iter().map(|energy| {
                        let [f_a, f_s, m] = energy.forces;
                        [w_lig * f_a, w_lig * f_s, m]
                    });
                    moments.collect()
                })
                .collect();
            let mut greatest = 0.0_f64;
            for k in 0..path.states.len() {
                let mut variance = 0.0;
                for c in 0..3 {
                    let values = forces.iter().map(|network| network[k][c]);
                    let [mean, of_component] = mean_and_variance(values);
                    variance += of_component;
                    squares += mean * mean;
                }
                count += 1.0;
                greatest = greatest.max(variance.sqrt());
            }
            greatest
        })
        .collect();
    let scale = (squares / f64::max(count, 1.0))
        .sqrt()
        .max(f64::MIN_POSITIVE);
    deviations
        .iter()
        .map(|deviation| deviation / scale)
        .collect()
}
