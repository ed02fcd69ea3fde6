//! States of a training domain at which the networks of an ensemble disagree, and rays through them.

use crate::spot_check::random_paths;
use fe_driver::Ray;
use hinge::{HingeDeformation, HingeDesign, HingeSample, TrainingDomain};
use surrogate::{Surrogate, mean_and_variance};

/// Number of states drawn: a part of a thousandth of the domain has fifty.
const DRAWN: usize = 50_000;
/// Energies below this fraction of their median count as that fraction: their relative deviation has no effect on sheets.
const MIN_ENERGY: f64 = 0.01;
/// Minimum distance of two rays' states, where every coordinate has the range 1 over the domain.
const APART: f64 = 0.15;

/// A hinge state and the disagreement of the networks there.
#[derive(Clone, Copy)]
pub struct DoubtfulState {
    /// The hinge design.
    pub design: HingeDesign,
    /// Its deformation.
    pub state: HingeDeformation,
    /// Standard deviations over the networks: of the energies, relative to their mean or to a hundredth of the median energy,
    /// whichever is larger; of the forces (F_a, F_s, M_theta / w_lig) and of D, relative to the root mean square over the domain.
    /// Infinite if a value is not finite.
    pub doubts: [f64; 3],
}

impl DoubtfulState {
    /// The largest of the doubts.
    pub fn doubt(&self) -> f64 {
        self.doubts.into_iter().fold(0.0, f64::max)
    }
}

/// Random states of the training domain that the networks share, those with the largest doubt first.
pub fn doubtful_states(networks: &[Surrogate]) -> Vec<DoubtfulState> {
    let paths = random_paths((&networks[0]).into(), DRAWN, 1, 0);
    let designs: Vec<HingeDesign> = paths.iter().map(|path| path.hinge.design).collect();
    let states: Vec<HingeDeformation> = paths.iter().map(|path| path.hinge.path.at(1.0)).collect();
    let predicted: Vec<Vec<HingeSample>> = networks
        .iter()
        .map(|network| network.samples(&designs, &states))
        .collect();
    let forces = |k: usize, sample: &HingeSample| {
        [sample.f_a, sample.f_s, sample.m_theta / designs[k].w_lig]
    };
    let mut sizes: Vec<f64> = predicted[0].iter().map(|sample| sample.w.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let min_energy = MIN_ENERGY * sizes[DRAWN / 2];
    let root_mean_square = |square: &dyn Fn(usize, &HingeSample) -> f64| {
        let squares = predicted[0].iter().enumerate();
        (squares.map(|(k, sample)| square(k, sample)).sum::<f64>() / DRAWN as f64).sqrt()
    };
    let force_scale = root_mean_square(&|k, sample| forces(k, sample).iter().map(|f| f * f).sum());
    let damage_scale = root_mean_square(&|_, sample| sample.d * sample.d);
    let mut found: Vec<DoubtfulState> = (0..DRAWN)
        .map(|k| {
            let samples = || predicted.iter().map(|of| &of[k]);
            let of_force =
                |c: usize| mean_and_variance(samples().map(|sample| forces(k, sample)[c]))[1];
            let of_forces: f64 = (0..3).map(of_force).sum();
            let [_, of_damage] = mean_and_variance(samples().map(|sample| sample.d));
            DoubtfulState {
                design: designs[k],
                state: states[k],
                doubts: [
                    deviation(samples().map(|sample| sample.w), min_energy),
                    relative(of_forces, force_scale),
                    relative(of_damage, damage_scale),
                ],
            }
        })
        .collect();
    found.sort_by(|a, b| b.doubt().total_cmp(&a.doubt()));
    found
}

/// Standard deviation of energies relative to their mean, or to `min_energy` if that is larger.
fn deviation(energies: impl Iterator<Item = f64> + Clone, min_energy: f64) -> f64 {
    let [mean, variance] = mean_and_variance(energies);
    relative(variance, mean.abs().max(min_energy))
}

/// The root of a variance over a scale; infinite if it is not a number.
fn relative(variance: f64, scale: f64) -> f64 {
    let deviation = variance.sqrt() / scale;
    if deviation.is_nan() {
        return f64::INFINITY;
    }
    deviation
}

/// At most `count` rays through the first of the states that are not close to each other or to the mirror image of each
/// other, each ending at `beyond` times its state.
pub fn rays_through<'a>(
    states: impl Iterator<Item = &'a DoubtfulState>,
    domain: &TrainingDomain,
    count: usize,
    beyond: f64,
) -> Vec<Ray> {
    let mut taken: Vec<[f64; 5]> = Vec::new();
    let mut rays = Vec::new();
    for DoubtfulState { design, state, .. } in states {
        if rays.len() == count {
            break;
        }
        let at = coordinates(domain, design, state);
        let image = coordinates(domain, &design.mirrored(), &state.mirrored());
        let far = |other: &[f64; 5]| distance(&at, other).min(distance(&image, other)) > APART;
        if taken.iter().all(far) {
            taken.push(at);
            rays.push(Ray {
                design: *design,
                end: state.at(beyond),
            });
        }
    }
    rays
}

fn distance(one: &[f64; 5], other: &[f64; 5]) -> f64 {
    let squares = std::iter::zip(one, other).map(|(x, y)| (x - y).powi(2));
    squares.sum::<f64>().sqrt()
}

/// log w_lig, alpha and the coordinates of the domain over their ranges in the domain; 0 for a coordinate that is constant there.
fn coordinates(
    domain: &TrainingDomain,
    design: &HingeDesign,
    state: &HingeDeformation,
) -> [f64; 5] {
    let [eta_a, eta_s, theta] = domain.coordinates(design, state);
    let [of_a, of_s, of_theta] = domain.bounds();
    let over = |value: f64, [from, to]: [f64; 2]| if to > from { value / (to - from) } else { 0.0 };
    [
        over(design.w_lig.ln(), domain.w_lig.map(f64::ln)),
        over(design.alpha, domain.alpha),
        over(eta_a, of_a),
        over(eta_s, of_s),
        over(theta, of_theta),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use hinge::HingeConstants;
    use std::f64::consts::PI;
    use std::path::Path;

    fn doubtful(w_lig: f64, alpha: f64, eta_s: f64, doubt: f64) -> DoubtfulState {
        DoubtfulState {
            design: HingeConstants::PAPER.hinge(w_lig, alpha),
            state: HingeDeformation::from_eta(0.1, eta_s, 0.3, w_lig),
            doubts: [0.5 * doubt, doubt, 0.0],
        }
    }

    #[test]
    fn deviations_are_relative_to_the_mean_or_the_minimum_energy() {
        let relative = |energies: [f64; 2], min| deviation(energies.into_iter(), min);
        assert!((relative([9.0, 11.0], 1.0) - 0.02f64.sqrt()).abs() < 1e-15);
        assert!((relative([0.0, 0.2], 1.0) - 0.02f64.sqrt()).abs() < 1e-15);
        assert_eq!(relative([1.0, f64::NAN], 1.0), f64::INFINITY);
    }

    #[test]
    fn the_doubt_of_a_state_is_the_largest_of_its_quantities() {
        assert_eq!(relative(0.04, 10.0), 0.02);
        assert_eq!(doubtful(10.0, 1.0, 0.2, 0.3).doubt(), 0.3);
    }

    /// Networks of different seeds disagree about every quantity, and a network with itself about none.
    #[test]
    fn energies_forces_and_damage_are_doubted() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/pet-0.5mm");
        let [one, other] = ["small", "distilled"].map(|name| {
            Surrogate::load(&folder.join(name).with_added_extension("safetensors")).unwrap()
        });
        let states = doubtful_states(&[one.clone(), other]);
        assert!(states.is_sorted_by(|a, b| a.doubt() >= b.doubt()));
        let mean = |i: usize| states.iter().map(|state| state.doubts[i]).sum::<f64>();
        assert!((0..3).all(|i| mean(i) > 1e-3 * states.len() as f64));
        let same = doubtful_states(&[one.clone(), one]);
        assert!(same.iter().all(|state| state.doubts == [0.0; 3]));
    }

    #[test]
    fn rays_pass_through_states_far_from_each_other_and_from_their_mirror_images() {
        let domain = TrainingDomain::from_box(
            [[-0.8, 0.2], [-0.4, 0.4], [-0.1, 1.3]],
            [5.0, 25.0],
            [0.8, 2.3],
        );
        let states = [
            doubtful(10.0, 1.0, 0.2, 0.9),
            doubtful(10.1, 1.0, 0.2, 0.8),
            doubtful(10.0, PI - 1.0, -0.2, 0.7),
            doubtful(20.0, 1.0, 0.2, 0.6),
            doubtful(10.0, 1.0, -0.2, 0.5),
        ];
        let rays = rays_through(states.iter(), &domain, 10, 1.1);
        let found: Vec<_> = rays.iter().map(|ray| ray.design.w_lig).collect();
        assert_eq!(found, [10.0, 20.0, 10.0]);
        assert_eq!(rays[0].end, states[0].state.at(1.1));
        assert_eq!(rays_through(states.iter(), &domain, 2, 1.1).len(), 2);
    }
}
