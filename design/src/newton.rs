//! A minimum of the potential (10) at one load factor, by a damped Newton method.
//!
//! With S the diagonal of the tangent at the start, a step solves (H + sigma S) d = -grad Pi with the
//! smallest sigma found that makes the matrix positive definite, is cut to a length in which the
//! rotations stay moderate, and is accepted if Pi falls by a part of what the model predicts.
//!
//! Where hinges are much stiffer in translation than in rotation, a step along the mechanism stretches
//! them to second order, and the forces f of that stretch, large and gone with the next step, would
//! spoil the geometric part f . d2(eps) of H. It counts instead with the forces expected by their rates
//! (Magisano, Leonetti and Garcea 2017), until the state is stationary or no step from it is found.

use crate::equilibrium::SolverSettings;
use crate::kinematics::Configuration;
use crate::panel_vectors::spread;
use crate::potential::{Potential, State, moved};
use crate::stroke::{HeldFactor, dot};

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
pub(crate) const LEVEL: f64 = 1e-9;

/// Where a minimisation ended.
pub(crate) struct Minimum {
    pub state: State,
    pub tangent: Vec<f64>,
    /// `None` if the tangent is singular.
    pub factor: Option<HeldFactor>,
    pub iterations: usize,
    /// Whether the tangent lost its positive definiteness on the way.
    pub unstable: bool,
}

/// Why there is no minimum.
pub(crate) struct Failure {
    pub residual: f64,
    pub iterations: usize,
}

impl Potential<'_> {
    /// A minimum near `start`, where the hinge forces are expected to be `forces`.
    pub fn minimise(
        &self,
        start: Configuration,
        forces: Vec<[f64; 3]>,
        settings: &SolverSettings,
    ) -> Result<Minimum, Failure> {
        let mut state = self.state(start).ok_or(Failure {
            residual: f64::INFINITY,
            iterations: 0,
        })?;
        state.expected = Some(forces);
        let (mut scale, mut memory) = (None, Vec::new());
        let (mut longest, mut unstable) = (LONGEST_STEP, false);
        for iterations in 0..settings.max_iterations {
            let stationary = state.is_balanced(settings.tolerance);
            if stationary {
                state.expected = None;
            }
            let tangent = self.tangent(&state);
            let scale = scale.get_or_insert_with(|| self.pattern.shift_scale(&tangent));
            let factor = self.factorise(&tangent, std::mem::take(&mut memory));
            let stable = factor
                .as_ref()
                .filter(|factor| factor.unstable_directions() == 0);
            unstable |= stable.is_none();
            let next = match stable {
                Some(_) if stationary => None,
                Some(factor) => self.step(&state, factor, &mut longest, settings),
                None if stationary => self.escape(&state, &tangent, scale),
                None => self
                    .shifted_factor(&tangent, scale)
                    .and_then(|factor| self.step(&state, &factor, &mut longest, settings)),
            };
            let residual = state.residual;
            match next {
                Some(next) => state = next,
                None if state.expected.is_some() => state.expected = None,
                None if stationary || residual <= settings.loose_tolerance => {
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
            memory = factor.map_or(Vec::new(), |held| held.factor.values);
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
        factor: &HeldFactor,
        longest: &mut f64,
        settings: &SolverSettings,
    ) -> Option<State> {
        let downhill: Vec<f64> = state.gradient.iter().map(|g| -g).collect();
        let direction = factor.solve(self.pattern, &downhill);
        let slope = dot(&state.gradient, &direction);
        let motion = spread(self.free, &direction);
        let length = self.length(state, &motion);
        let mut fraction = (*longest / length).min(1.0);
        while fraction > SHORTEST_FRACTION {
            if let Some(mut next) = self.moved(state, &motion, fraction) {
                let fall = state.potential - next.potential;
                let predicted = -slope * fraction * (1.0 - 0.5 * fraction);
                // Where Pi is lost in rounding, its slope along the step is not.
                let level = fall.abs() <= LEVEL * state.magnitude
                    && dot(&next.gradient, &direction).abs() <= 0.5 * slope.abs();
                if fall >= SUFFICIENT_FALL * predicted || level {
                    *longest = LONGEST_STEP.min(2.0 * fraction * length).max(*longest);
                    // Beside a saddle the residual grows before it falls.
                    let progress = factor.shifted
                        || state.residual > settings.loose_tolerance
                        || next.residual <= 0.5 * state.residual;
                    let rates = self.force_rates(state, &motion);
                    next.expected = Some(moved(&state.forces(), &rates, fraction));
                    return progress.then_some(next);
                }
            }
            fraction *= STEP_CUT;
            *longest = fraction * length;
        }
        None
    }

    /// The factors of the tangent in `memory` that earlier ones have left, bordered if the sheet is
    /// driven.
    pub fn factorise(&self, tangent: &[f64], memory: Vec<f64>) -> Option<HeldFactor> {
        let factor = self.pattern.factorise(tangent, memory)?;
        HeldFactor::new(self.pattern, factor, self.control.stroke())
    }

    /// H + sigma S, positive definite; `None` if no reasonable sigma makes it so.
    fn shifted_factor(&self, tangent: &[f64], scale: &[f64]) -> Option<HeldFactor> {
        let [mut shift, growth, greatest] = SHIFTS;
        while shift <= greatest {
            let shifted = self
                .pattern
                .shifted(tangent, scale.iter().map(|entry| shift * entry));
            match self.factorise(&shifted, Vec::new()) {
                Some(mut factor) if factor.unstable_directions() == 0 => {
                    factor.shifted = true;
                    return Some(factor);
                }
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
            direction = factor.solve(self.pattern, &direction);
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
