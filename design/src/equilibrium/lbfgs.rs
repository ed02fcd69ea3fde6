//! The limited-memory BFGS method (Liu and Nocedal 1989), with which the paper minimises (10); the
//! baseline for Newton's method.
//!
//! Rotations are scaled by the size of a panel; steps satisfy the weak Wolfe conditions. Under displacement
//! control steps are orthogonal to the direction of the stroke.

use crate::equilibrium::displacement_control::dot;
use crate::equilibrium::lbfgs_memory::Memory;
use crate::equilibrium::load_step::{DescentEnd, Effort};
use crate::equilibrium::newton::{Failure, Minimum};
use crate::equilibrium::potential::{Potential, State, moved};
use crate::hinge_law::Order;
use crate::sheet::kinematics::Configuration;

/// Constants of the weak Wolfe conditions: sufficient decrease and curvature.
const WOLFE: [f64; 2] = [1e-4, 0.9];
/// Maximum number of trial steps in one line search.
const TRIALS: usize = 40;
/// Length of the first step, relative to the size of a panel.
const FIRST_STEP: f64 = 1e-3;
/// Change of Pi, relative to the sum of the magnitudes of its terms, below which it is rounding error.
const LEVEL: f64 = 1e-13;

impl Potential<'_> {
    /// A minimum near `start`, found in at most `max_iterations`.
    pub fn minimise_lbfgs(
        &self,
        start: Configuration,
        max_iterations: usize,
        effort: &mut Effort,
    ) -> Result<Minimum, Failure> {
        let settings = &self.solver.settings;
        let mut state = self.forces(start).ok_or(Failure::NOT_FINITE)?;
        let scale = vec![[1.0, 1.0, 1.0 / self.panel_size]; state.configuration.len()];
        let scale = self.solver.pattern.gather(&scale);
        let mut gradient = self.scaled(&state, &scale);
        let mut memory = Memory::default();
        let mut iterations = 0;
        while !state.is_balanced(settings.tolerance) && iterations < max_iterations {
            let direction = memory.direction(&gradient, FIRST_STEP * self.panel_size);
            let Some((next, fraction)) = self.wolfe_step(&state, &gradient, &direction, &scale)
            else {
                break;
            };
            let next_gradient = self.scaled(&next, &scale);
            let change: Vec<f64> = std::iter::zip(&next_gradient, &gradient)
                .map(|(to, from)| to - from)
                .collect();
            let step: Vec<f64> = direction.iter().map(|d| fraction * d).collect();
            memory.remember(step, change);
            (state, gradient, iterations) = (next, next_gradient, iterations + 1);
        }
        effort.iterations += iterations;
        effort.factorisations += 1;
        if state.residual > settings.loose_tolerance() {
            return Err(Failure {
                residual: state.residual,
                end: if iterations < max_iterations {
                    DescentEnd::Stagnated
                } else {
                    DescentEnd::Iterations
                },
            });
        }
        let state = self.state(state.configuration);
        let state = state.ok_or(Failure::NOT_FINITE)?;
        let tangent = self.tangent(&state);
        Ok(Minimum {
            factor: self.factorise(&tangent, Vec::new()),
            tangent,
            state,
        })
    }

    fn forces(&self, configuration: Configuration) -> Option<State> {
        self.state_up_to(configuration, Order::Forces)
    }

    /// The gradient in scaled coordinates; under displacement control its part orthogonal to the stroke.
    fn scaled(&self, state: &State, scale: &[f64]) -> Vec<f64> {
        let times =
            |v: &[f64]| -> Vec<f64> { std::iter::zip(v, scale).map(|(v, s)| v * s).collect() };
        let mut gradient = times(&state.gradient);
        if let Some(stroke) = self.solver.stroke() {
            let border = times(stroke.direction());
            let along = dot(&border, &gradient) / dot(&border, &border);
            for (g, c) in std::iter::zip(&mut gradient, border) {
                *g -= along * c;
            }
        }
        gradient
    }

    /// A step along `direction`, by bisection between a step that is too long and one that is too short.
    fn wolfe_step(
        &self,
        state: &State,
        gradient: &[f64],
        direction: &[f64],
        scale: &[f64],
    ) -> Option<(State, f64)> {
        let scaled: Vec<f64> = std::iter::zip(direction, scale)
            .map(|(d, s)| d * s)
            .collect();
        let motion = self.solver.pattern.spread(&scaled);
        let slope = dot(gradient, direction);
        let (mut near, mut far, mut fraction) = (0.0, f64::INFINITY, 1.0);
        for _ in 0..TRIALS {
            let configuration = moved(&state.configuration, &motion, fraction);
            let next = self.forces(configuration);
            let falls = next.as_ref().is_some_and(|next| {
                let fall = state.potential - next.potential;
                fall >= -WOLFE[0] * fraction * slope || fall.abs() <= LEVEL * state.magnitude
            });
            match next {
                Some(next) if falls => {
                    if dot(&self.scaled(&next, scale), direction) >= WOLFE[1] * slope {
                        return Some((next, fraction));
                    }
                    near = fraction;
                }
                _ => far = fraction,
            }
            fraction = if far.is_finite() {
                0.5 * (near + far)
            } else {
                2.0 * near
            };
        }
        None
    }
}
