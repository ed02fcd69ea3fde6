//! A minimum of the potential (10) at one load factor, by a damped Newton method.
//!
//! With S the diagonal of the tangent at the start, a step solves (H + sigma S) d = -grad Pi with the
//! smallest sigma found that makes the matrix positive definite, is cut to a length in which the
//! rotations stay moderate, and is accepted if Pi falls by a part of what the model predicts.

use crate::equilibrium::{HingedSheet, SolverSettings};
use crate::hinge_law::{HingeEnergy, Order};
use crate::kinematics::{Configuration, HingeMotion};
use crate::panel_vectors::{add_at_hinge, at_hinge, gather, spread};
use crate::tangent::{Factor, TangentPattern};
use hinge::HingeDeformation;

/// Longest step: rotations in rad, hinge translations in panel sizes.
const LONGEST_STEP: f64 = 0.5;
/// Part of the predicted fall of Pi that a step must achieve.
const SUFFICIENT_FALL: f64 = 1e-4;
/// A step is cut by this factor when it fails.
const STEP_CUT: f64 = 0.25;
/// Steps shorter than this fraction of the Newton step are given up.
const SHORTEST_FRACTION: f64 = 1e-9;
/// First sigma tried, its growth, and where trying ends.
const SHIFTS: [f64; 3] = [1e-8, 8.0, 1e8];
/// Curvature over S below which a direction counts as unstable.
const NEGATIVE_CURVATURE: f64 = -1e-11;
/// Change of Pi over the sum of its terms' sizes below which it may be rounding: a learned energy is
/// a difference of much greater numbers.
const LEVEL: f64 = 1e-9;

/// The potential (10) at one load factor.
pub(crate) struct Potential<'a> {
    pub sheet: HingedSheet<'a>,
    pub pattern: &'a TangentPattern,
    /// Numbers of the free degrees of freedom.
    pub free: &'a [Option<usize>],
    /// zeta (F_x, F_y, M) per panel.
    pub loads: Vec<[f64; 3]>,
    /// Size of a panel, which makes moments comparable with forces (mm).
    pub panel_size: f64,
    /// (F_x, F_y, M) per panel at zeta = 1.
    pub full_loads: &'a [[f64; 3]],
}

/// The potential and its first derivatives at a configuration.
pub(crate) struct State {
    pub configuration: Configuration,
    pub motions: Vec<HingeMotion>,
    pub energies: Vec<HingeEnergy>,
    pub potential: f64,
    /// Sum of the sizes of the terms of `potential`.
    magnitude: f64,
    /// d Pi / d q over the free degrees of freedom.
    gradient: Vec<f64>,
    /// Greatest unbalanced force over the greatest force.
    pub residual: f64,
}

/// Where a minimisation ended.
pub(crate) struct Minimum {
    pub state: State,
    pub tangent: Vec<f64>,
    /// `None` if the tangent is singular.
    pub factor: Option<Factor>,
    pub iterations: usize,
    /// Whether the tangent lost its positive definiteness on the way.
    pub unstable: bool,
}

/// Why there is no minimum.
pub(crate) struct Failure {
    pub residual: f64,
    pub iterations: usize,
}

impl State {
    pub fn deformations(&self) -> Vec<HingeDeformation> {
        self.motions.iter().map(HingeMotion::deformation).collect()
    }
}

impl Potential<'_> {
    /// `None` where the potential is not finite.
    pub fn state(&self, configuration: Configuration) -> Option<State> {
        let sheet = self.sheet.sheet;
        let motions: Vec<HingeMotion> = (0..sheet.hinges.len())
            .map(|hinge| HingeMotion::new(sheet, hinge, &configuration))
            .collect();
        let deformations: Vec<HingeDeformation> =
            motions.iter().map(HingeMotion::deformation).collect();
        let energies = self.sheet.energies(&deformations, Order::Tangent);

        let mut unbalanced: Vec<[f64; 3]> = (self.loads.iter())
            .map(|load| load.map(|force| -force))
            .collect();
        for ((hinge, motion), energy) in sheet.hinges.iter().zip(&motions).zip(&energies) {
            add_at_hinge(&mut unbalanced, hinge, motion.forces(energy.forces));
        }
        let stored = energies.iter().map(|energy| energy.w);
        let works = std::iter::zip(&self.loads, &configuration)
            .flat_map(|(load, motion)| std::iter::zip(load, motion).map(|(f, u)| f * u));
        let terms = stored.chain(works.map(|work| -work));
        let gradient = gather(self.free, &unbalanced);
        let state = State {
            potential: terms.clone().sum(),
            magnitude: terms.map(f64::abs).sum(),
            residual: self.residual(&gradient, &energies),
            gradient,
            configuration,
            motions,
            energies,
        };
        let finite = state.potential.is_finite() && state.gradient.iter().all(|g| g.is_finite());
        finite.then_some(state)
    }

    /// Greatest unbalanced force on a panel over the greatest load or hinge force.
    fn residual(&self, gradient: &[f64], energies: &[HingeEnergy]) -> f64 {
        let unbalanced = self.greatest(spread(self.free, gradient).into_iter());
        if unbalanced == 0.0 {
            return 0.0;
        }
        let loads = self.greatest(self.full_loads.iter().copied());
        let inner = self.greatest(energies.iter().map(|energy| energy.forces));
        unbalanced / loads.max(inner)
    }

    /// Greatest of forces and moments, as a force (N).
    fn greatest(&self, forces: impl Iterator<Item = [f64; 3]>) -> f64 {
        forces
            .map(|[x, y, moment]| x.hypot(y).max(moment.abs() / self.panel_size))
            .fold(0.0, f64::max)
    }

    fn tangent(&self, state: &State) -> Vec<f64> {
        let blocks = std::iter::zip(&state.motions, &state.energies);
        self.pattern
            .assemble(blocks.map(|(motion, energy)| motion.stiffness(energy)))
    }

    fn moved(&self, state: &State, motion: &[[f64; 3]], fraction: f64) -> Option<State> {
        let configuration = std::iter::zip(&state.configuration, motion)
            .map(|(q, d)| std::array::from_fn(|c| q[c] + fraction * d[c]))
            .collect();
        self.state(configuration)
    }

    /// Greatest panel rotation (rad) or hinge translation (panel sizes) of a motion.
    fn length(&self, state: &State, motion: &[[f64; 3]]) -> f64 {
        std::iter::zip(&self.sheet.sheet.hinges, &state.motions)
            .map(|(hinge, hinge_motion)| {
                let motions = at_hinge(hinge, motion);
                let [along, across, _] = hinge_motion.rates(motions);
                let translation = along.hypot(across) / self.panel_size;
                translation.max(motions[2].abs()).max(motions[5].abs())
            })
            .fold(0.0, f64::max)
    }

    /// A minimum near `start`.
    pub fn minimise(
        &self,
        start: Configuration,
        settings: &SolverSettings,
    ) -> Result<Minimum, Failure> {
        let mut state = self.state(start).ok_or(Failure {
            residual: f64::INFINITY,
            iterations: 0,
        })?;
        let mut tangent = self.tangent(&state);
        let scale = self.shift_scale(&tangent);
        let (mut longest, mut unstable) = (LONGEST_STEP, false);
        for iterations in 0..settings.max_iterations {
            let factor = self.pattern.factorise(&tangent);
            let stable = factor.as_ref().filter(|factor| factor.negative_pivots == 0);
            unstable |= stable.is_none();
            let stationary = state.residual <= settings.tolerance;
            let next = match stable {
                Some(_) if stationary => None,
                Some(factor) => self.step(&state, factor, &mut longest, settings),
                None if stationary => self.escape(&state, &tangent, &scale),
                None => self
                    .shifted_factor(&tangent, &scale)
                    .and_then(|factor| self.step(&state, &factor, &mut longest, settings)),
            };
            let residual = state.residual;
            match next {
                Some(next) => state = next,
                None if residual <= settings.loose_tolerance => {
                    return Ok(Minimum {
                        state,
                        tangent,
                        factor,
                        iterations,
                        unstable,
                    });
                }
                None => {
                    return Err(Failure {
                        residual,
                        iterations,
                    });
                }
            }
            tangent = self.tangent(&state);
        }
        Err(Failure {
            residual: state.residual,
            iterations: settings.max_iterations,
        })
    }

    /// The state after a damped Newton step; `None` if there is no better one along it, or if the
    /// residual is small and no longer halves. `longest` is the length (see
    /// [`length`](Self::length)) steps are cut to, and learns from the outcome.
    fn step(
        &self,
        state: &State,
        factor: &Factor,
        longest: &mut f64,
        settings: &SolverSettings,
    ) -> Option<State> {
        let mut direction: Vec<f64> = state.gradient.iter().map(|g| -g).collect();
        self.pattern.solve(factor, &mut direction);
        let slope = dot(&state.gradient, &direction);
        let motion = spread(self.free, &direction);
        let length = self.length(state, &motion);
        let mut fraction = (*longest / length).min(1.0);
        while fraction > SHORTEST_FRACTION {
            if let Some(next) = self.moved(state, &motion, fraction) {
                let fall = state.potential - next.potential;
                let predicted = -slope * fraction * (1.0 - 0.5 * fraction);
                // Where Pi is lost in rounding, its slope along the step is not.
                let level = fall.abs() <= LEVEL * state.magnitude
                    && dot(&next.gradient, &direction).abs() <= 0.5 * slope.abs();
                if fall >= SUFFICIENT_FALL * predicted || level {
                    *longest = LONGEST_STEP.min(2.0 * fraction * length).max(*longest);
                    let progress = state.residual > settings.loose_tolerance
                        || next.residual <= 0.5 * state.residual;
                    return progress.then_some(next);
                }
            }
            fraction *= STEP_CUT;
            *longest = fraction * length;
        }
        None
    }

    /// S: the sizes of the diagonal of a tangent, none zero.
    fn shift_scale(&self, tangent: &[f64]) -> Vec<f64> {
        let mut scale = self.pattern.diagonal(tangent);
        let greatest = scale
            .iter()
            .fold(0.0_f64, |max, entry| max.max(entry.abs()));
        let least = if greatest > 0.0 {
            1e-12 * greatest
        } else {
            1.0
        };
        scale
            .iter_mut()
            .for_each(|entry| *entry = entry.abs().max(least));
        scale
    }

    /// H + sigma S, positive definite; `None` if no reasonable sigma makes it so.
    fn shifted_factor(&self, tangent: &[f64], scale: &[f64]) -> Option<Factor> {
        let [mut shift, growth, greatest] = SHIFTS;
        while shift <= greatest {
            let shifted = self
                .pattern
                .shifted(tangent, scale.iter().map(|entry| shift * entry));
            match self.pattern.factorise(&shifted) {
                Some(factor) if factor.negative_pivots == 0 => return Some(factor),
                _ => shift *= growth,
            }
        }
        None
    }

    /// A lower state beside a stationary point that is no minimum: along the direction of the most
    /// negative curvature, found by inverse iteration.
    fn escape(&self, state: &State, tangent: &[f64], scale: &[f64]) -> Option<State> {
        let factor = self.shifted_factor(tangent, scale)?;
        // Any start that no symmetry of the sheet makes orthogonal to the direction.
        let mut direction: Vec<f64> = (1..=scale.len()).map(|i| (i as f64).sqrt().sin()).collect();
        for _ in 0..20 {
            for (component, scale) in std::iter::zip(&mut direction, scale) {
                *component *= scale;
            }
            self.pattern.solve(&factor, &mut direction);
            let norm = dot(&direction, &direction).sqrt();
            direction
                .iter_mut()
                .for_each(|component| *component /= norm);
        }
        let (product, _) = self.pattern.product(tangent, &direction);
        let size: f64 = std::iter::zip(&direction, scale)
            .map(|(d, s)| d * d * s)
            .sum();
        if dot(&direction, &product) >= NEGATIVE_CURVATURE * size {
            return None;
        }
        let motion = spread(self.free, &direction);
        let mut fraction = 0.1 / self.length(state, &motion);
        for _ in 0..20 {
            let beside = [fraction, -fraction].map(|f| self.moved(state, &motion, f));
            let lowest = beside
                .into_iter()
                .flatten()
                .min_by(|a, b| a.potential.total_cmp(&b.potential))
                .filter(|beside| beside.potential < state.potential);
            if lowest.is_some() {
                return lowest;
            }
            fraction *= STEP_CUT;
        }
        None
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    std::iter::zip(a, b).map(|(a, b)| a * b).sum()
}
