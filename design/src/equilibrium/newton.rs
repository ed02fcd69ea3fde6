//! Minimisation of the potential (10) at one load factor by a damped Newton method.
//!
//! Let S be the diagonal of the tangent at the start. A step solves (H + sigma S) d = -grad Pi with
//! the smallest tested sigma that makes the matrix positive definite. It is shortened until the
//! rotations are moderate, and accepted if Pi decreases by a fraction of the predicted decrease.
//!
//! If hinges are much stiffer in translation than in rotation, a step along the mechanism stretches
//! them to second order. The forces f of that stretch are large, vanish with the next step, and
//! would corrupt the geometric part f . d2(eps) of H. That part therefore uses the forces predicted
//! by their rates (Magisano, Leonetti and Garcea 2017), until the state is stationary or no descent
//! step is found.

use crate::{
    equilibrium::{
        displacement_control::HeldFactor,
        load_step::{DescentEnd, StepTangent},
        potential::{Branch, PotentialState, moved},
        predictor::PathPoint,
    },
    hinge_law::Order,
};
use std::iter::zip;
use support::vectors::dot;

/// Maximum length of a step: rotations in rad, hinge translations in panel sizes.
const LONGEST_STEP: f64 = 0.5;
/// Length to which a step that is shortened by a shift is extended.
const REACH: f64 = 0.05;
/// Fraction of the predicted decrease of Pi that a step must achieve.
const SUFFICIENT_FALL: f64 = 1e-4;
/// Factor by which a rejected step is shortened.
const STEP_CUT: f64 = 0.25;
/// Steps shorter than this fraction of the Newton step are abandoned.
const SHORTEST_FRACTION: f64 = 1e-9;
/// First sigma, its growth factor, and its maximum.
const SHIFTS: [f64; 3] = [1e-8, 8.0, 1e8];
/// Curvature relative to S below which a direction is considered unstable.
const NEGATIVE_CURVATURE: f64 = -1e-11;
/// Change of Pi, relative to the sum of the magnitudes of its terms, below which it may be rounding
/// error: a learned energy is a difference of much larger numbers.
pub(crate) const LEVEL: f64 = 1e-9;

pub(crate) struct Minimum {
    pub state: PotentialState,
    pub tangent: StepTangent,
}

impl Minimum {
    pub(crate) fn is_stable(&self) -> bool {
        self.tangent.factor.as_ref().is_some_and(HeldFactor::is_stable)
    }
}

/// A minimisation that ended without a minimum.
#[derive(Debug)]
pub(crate) struct Failure {
    pub residual: f64,
    pub end: DescentEnd,
}

impl Failure {
    pub(crate) const EXHAUSTED: Self =
        Self { residual: f64::INFINITY, end: DescentEnd::Increments };
    pub(crate) const STOPPED: Self = Self { residual: f64::INFINITY, end: DescentEnd::Stopped };
    const NOT_FINITE: Self = Self { residual: f64::INFINITY, end: DescentEnd::NotFinite };
}

impl Branch<'_> {
    /// A minimum near `start`, at lower energy.
    pub(crate) fn minimum(&mut self, start: &PathPoint) -> Result<Minimum, Failure> {
        self.descended(start, self.solver.settings.max_iterations)
    }

    /// The same in a number of iterations at most.
    pub(crate) fn descended(
        &mut self,
        start: &PathPoint,
        iterations: usize,
    ) -> Result<Minimum, Failure> {
        let settings = &self.solver.settings;
        let mut state = self.state_at(start, Order::Tangent).ok_or(Failure::NOT_FINITE)?;
        let (mut scale, mut memory) = (None, Vec::new());
        let (mut longest, mut shift) = (LONGEST_STEP, SHIFTS[0]);
        for _ in 0..iterations {
            let stationary = state.is_balanced(settings.tolerance);
            if stationary {
                state.expected = None;
            }
            let values = self.tangent(&state);
            let scale = scale.get_or_insert_with(|| self.solver.pattern.shift_scale(&values));
            let factor = self.factorise(&values, std::mem::take(&mut memory));
            let stable = factor.as_ref().filter(|factor| factor.is_stable());
            let next = match stable {
                Some(_) if stationary => None,
                Some(factor) => self.step(&state, factor, &mut longest),
                None => {
                    let shifted = self.shifted_factor(&values, scale, &mut shift);
                    shifted.and_then(|factor| {
                        if stationary {
                            self.escape(&state, &values, scale, &factor)
                        } else {
                            self.step(&state, &factor, &mut longest)
                        }
                    })
                }
            };
            let residual = state.residual;
            match next {
                Some(next) => {
                    self.effort.iterations += 1;
                    state = next;
                }
                None if state.expected.is_some() => state.expected = None,
                None if stationary || residual <= settings.loose_tolerance() => {
                    return Ok(Minimum { state, tangent: StepTangent { values, factor } });
                }
                None => {
                    let end = DescentEnd::Stagnated;
                    return Err(Failure { residual, end });
                }
            }
            memory = factor.map_or(Vec::new(), |held| held.factor.values);
        }
        Err(Failure { residual: state.residual, end: DescentEnd::Iterations })
    }

    /// The state after a damped Newton step; `None` if no state along it is better, or if the
    /// residual is small and no longer halves. `longest` is the maximum step length (see
    /// [`length`](Self::length)), adapted after every step.
    fn step(
        &self,
        state: &PotentialState,
        factor: &HeldFactor,
        longest: &mut f64,
    ) -> Option<PotentialState> {
        let settings = &self.solver.settings;
        let downhill: Vec<f64> = state.gradient.iter().map(|g| -g).collect();
        let direction = factor.solve(&self.solver.pattern, &downhill);
        let slope = dot(&state.gradient, &direction);
        let motion = self.solver.pattern.spread(&direction);
        let length = self.length(state, &motion);
        // A shifted step is too short where the energy curves downwards.
        let reach = if factor.shifted { REACH / length } else { 1.0 };
        let mut fraction = (*longest / length).min(reach.max(1.0));
        // A search that fails leaves the maximum step length as it was.
        let mut cut = false;
        while fraction > SHORTEST_FRACTION {
            if let Some(mut next) = self.moved(state, &motion, fraction) {
                let fall = state.potential - next.potential;
                let predicted = -slope * fraction * (1.0 - 0.5 * fraction.min(1.0));
                // If the change of Pi is lost in rounding, its slope along the step is still
                // accurate.
                let level = fall.abs() <= LEVEL * state.magnitude
                    && dot(&next.gradient, &direction).abs() <= 0.5 * slope.abs();
                if fall >= SUFFICIENT_FALL * predicted || level {
                    let reached = LONGEST_STEP.min(2.0 * fraction * length);
                    *longest = if cut { reached } else { reached.max(*longest) };
                    // Near a saddle point the residual grows before it decreases.
                    let progress = factor.shifted
                        || state.residual > settings.loose_tolerance()
                        || next.residual <= 0.5 * state.residual;
                    let rates = self.force_rates(state, &motion);
                    next.expected = Some(moved(&state.forces(), &rates, fraction));
                    return progress.then_some(next);
                }
            }
            fraction *= STEP_CUT;
            cut = true;
        }
        None
    }

    /// The factors of the tangent, stored in `memory` of earlier factors, with the border under
    /// displacement control.
    fn factorise(&mut self, tangent: &[f64], memory: Vec<f64>) -> Option<HeldFactor> {
        self.effort.factorisations += 1;
        let factor = self.solver.pattern.factorise(tangent, memory)?;
        HeldFactor::new(&self.solver.pattern, factor, self.solver.stroke())
    }

    /// The tangent of a state and its factors.
    pub(crate) fn factorised(&mut self, state: &PotentialState) -> StepTangent {
        let values = self.tangent(state);
        let memory = std::mem::take(&mut self.spare);
        StepTangent { factor: self.factorise(&values, memory), values }
    }

    /// H + sigma S, positive definite; `None` if no sigma up to the maximum makes it so. The search
    /// begins below `shift`, the sigma found last.
    fn shifted_factor(
        &mut self,
        tangent: &[f64],
        scale: &[f64],
        shift: &mut f64,
    ) -> Option<HeldFactor> {
        let [first, growth, maximum] = SHIFTS;
        *shift = first.max(*shift / growth);
        while *shift <= maximum {
            let pattern = &self.solver.pattern;
            let shifted = pattern.shifted(tangent, scale.iter().map(|entry| *shift * entry));
            match self.factorise(&shifted, Vec::new()) {
                Some(mut factor) if factor.is_stable() => {
                    factor.shifted = true;
                    return Some(factor);
                }
                _ => *shift *= growth,
            }
        }
        None
    }

    /// A state of lower energy near a stationary point that is no minimum, along the direction of
    /// the most negative curvature, found by inverse iteration with the factors of a shifted
    /// tangent.
    fn escape(
        &self,
        state: &PotentialState,
        tangent: &[f64],
        scale: &[f64],
        factor: &HeldFactor,
    ) -> Option<PotentialState> {
        // A start vector that no symmetry of the sheet makes orthogonal to the direction.
        let mut direction: Vec<f64> = (1..=scale.len()).map(|i| (i as f64).sqrt().sin()).collect();
        for _ in 0..20 {
            for (component, scale) in zip(&mut direction, scale) {
                *component *= scale;
            }
            direction = factor.solve(&self.solver.pattern, &direction);
            let norm = dot(&direction, &direction).sqrt();
            direction.iter_mut().for_each(|component| *component /= norm);
        }
        let (product, _) = self.solver.pattern.product(tangent, &direction);
        let size: f64 = zip(&direction, scale).map(|(d, s)| d * d * s).sum();
        if dot(&direction, &product) >= NEGATIVE_CURVATURE * size {
            return None;
        }
        let motion = self.solver.pattern.spread(&direction);
        let mut fraction = 0.1 / self.length(state, &motion);
        for _ in 0..20 {
            let moved_to = [fraction, -fraction].map(|f| self.moved(state, &motion, f));
            let lowest = moved_to
                .into_iter()
                .flatten()
                .min_by(|a, b| a.potential.total_cmp(&b.potential))
                .filter(|moved_to| moved_to.potential < state.potential);
            if lowest.is_some() {
                return lowest;
            }
            fraction *= STEP_CUT;
        }
        None
    }
}
