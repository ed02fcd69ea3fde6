//! Following the load path, from the flat sheet or from where another path ended.
//!
//! An increment starts where the tangent at its beginning leads and ends at a minimum. It is halved
//! until there is one, and until the rates of the path explain its rotations,
//!
//! ```text
//! |dphi - (phi'_0 + phi'_1) dt / 2| <= |dphi| / 2,     or     |dphi| <= 3/2 |phi'| dt at one end
//! ```
//!
//! where the second will do if no tangent on the way was indefinite, and at an end towards which the
//! path slows down: towards a limit point it speeds up without bound. A leap that does not shrink with
//! its increment is a jump past a limit point.

use crate::equilibrium::{EquilibriumSolver, HingedSheet, Method};
use crate::kinematics::Configuration;
use crate::load_step::{LoadStep, Status, StepTangent};
use crate::newton::{LEVEL, Minimum};
use crate::panel_vectors::{gather, spread};
use crate::potential::{Control, Potential, State, moved};
use crate::sheet::Panel;
use crate::stroke::HeldFactor;

/// Rotation (rad) that an increment is meant not to exceed, by the rate at its beginning.
const LONGEST_INCREMENT: f64 = 0.2;
/// Part of a rotation that the rates at both ends may leave unexplained.
const UNEXPLAINED: f64 = 0.5;
/// How much further than the rate at one end a continuous path may turn.
const AHEAD_OF_RATE: f64 = 1.5;
/// A leap that halving the increment leaves this great is a jump; on a fold it is 1, on a path that
/// branches off like a square root 0.7.
const JUMP: f64 = 0.8;

/// A point on the path.
struct Reached {
    /// Part of the load, of the stroke and of the ways of the supports.
    at: f64,
    configuration: Configuration,
    /// Of the configuration.
    rate: Vec<[f64; 3]>,
    /// Energy of the hinges (N mm).
    stored: f64,
    /// Of the hinges, and their rates.
    forces: Vec<[f64; 3]>,
    force_rates: Vec<[f64; 3]>,
    /// Greatest rate of rotation (rad).
    speed: f64,
    /// Whether the path sped up on the way here.
    faster: bool,
    /// Greatest force so far, under load control that of the full load (N).
    force: f64,
}

impl EquilibriumSolver {
    /// Follows the load path from the flat sheet. The path ends early where a step diverges.
    ///
    /// # Panics
    /// If the sheet has another grid than the solver.
    pub fn path(&self, sheet: HingedSheet) -> Vec<LoadStep> {
        self.path_from(sheet, vec![[0.0; 3]; self.grid.panel_count()])
    }

    /// Follows the load path from an equilibrium without its loads: of a solver that follows another,
    /// from where the other's path ends.
    ///
    /// # Panics
    /// If the sheet or the start has another grid than the solver.
    pub fn path_from(&self, sheet: HingedSheet, start: Configuration) -> Vec<LoadStep> {
        assert_eq!(
            self.grid, sheet.sheet.grid,
            "the solver's grid is the sheet's"
        );
        assert_eq!(start.len(), self.grid.panel_count(), "a motion per panel");
        let mut path: Vec<LoadStep> = Vec::with_capacity(self.steps);
        let Some(mut reached) = self.unloaded(sheet, start.clone()) else {
            return vec![LoadStep {
                load_factor: 0.0,
                status: Status::Diverged,
                residual: f64::INFINITY,
                ..LoadStep::ideal(sheet.sheet, start)
            }];
        };
        for i in 1..=self.steps {
            let step = self.advance(sheet, &mut reached, i as f64 / self.steps as f64);
            let diverged = step.status == Status::Diverged;
            path.push(step);
            if diverged {
                break;
            }
        }
        path
    }

    /// Where the path begins; `None` if the energy is not finite there.
    fn unloaded(&self, sheet: HingedSheet, start: Configuration) -> Option<Reached> {
        let potential = self.potential(sheet, 0.0, 0.0);
        let force = match self.drive {
            None => potential.greatest(self.loads.iter().copied()),
            Some(_) => 0.0,
        };
        let state = potential.state(start)?;
        let factor = potential.factorise(&potential.tangent(&state), Vec::new());
        let reached = self.arrived(&potential, 0.0, &state, factor.as_ref(), f64::INFINITY);
        Some(Reached { force, ..reached })
    }

    /// A point of the path that was reached from one of the speed `speed_before`.
    fn arrived(
        &self,
        potential: &Potential,
        at: f64,
        state: &State,
        factor: Option<&HeldFactor>,
        speed_before: f64,
    ) -> Reached {
        let rate = self.rate(potential, state, factor);
        let speed = rate.iter().fold(0.0, |most, rate| rate[2].abs().max(most));
        Reached {
            at,
            configuration: state.configuration.clone(),
            stored: state.stored,
            forces: state.forces(),
            force_rates: potential.force_rates(state, &rate),
            rate,
            speed,
            faster: speed > speed_before,
            force: state.force,
        }
    }

    /// The load step to `to`, in as many increments as it takes; moves `reached` there.
    fn advance(&self, sheet: HingedSheet, reached: &mut Reached, to: f64) -> LoadStep {
        let mut increment = to - reached.at;
        let least = increment * 0.5_f64.powi(self.settings.max_halvings as i32);
        let (mut iterations, mut jumped, mut last_leap) = (0, false, 0.0);
        loop {
            increment = (to - reached.at)
                .min(increment)
                .min((LONGEST_INCREMENT / reached.speed).max(least));
            // The last increment ends exactly, so that rounding leaves no sliver of load behind.
            let at = if to - reached.at < 1.5 * increment {
                to
            } else {
                reached.at + increment
            };
            let potential = self.potential(sheet, at, reached.force);
            let seek = |(start, forces)| match self.settings.method {
                Method::Newton => potential.minimise(start, forces, &self.settings),
                Method::Lbfgs { max_iterations } => {
                    potential.minimise_lbfgs(start, &self.settings, max_iterations)
                }
            };
            let minimum = match seek(self.predicted(reached, at, 1.0)) {
                // Where the rates lead panels through each other, or over a ridge of the energy, the search
                // starts where it is.
                Err(failure) if failure.residual.is_infinite() && self.drive.is_none() => {
                    seek(self.predicted(reached, at, 0.0))
                }
                Ok(minimum) if self.climbed(reached, at, &minimum.state) => {
                    iterations += minimum.iterations;
                    seek(self.predicted(reached, at, 0.0))
                }
                minimum => minimum,
            };
            let minimum = match minimum {
                Ok(minimum) => minimum,
                Err(failure) => {
                    iterations += failure.iterations;
                    if increment > least {
                        increment *= 0.5;
                        continue;
                    }
                    return self.diverged(sheet, reached, failure.residual, iterations);
                }
            };
            iterations += minimum.iterations;
            let (state, factor) = (&minimum.state, minimum.factor.as_ref());
            let arrived = self.arrived(&potential, at, state, factor, reached.speed);
            if let Some(leap) = self.leap(reached, &arrived, minimum.unstable) {
                if increment > least {
                    (increment, last_leap) = (0.5 * increment, leap);
                    continue;
                }
                jumped |= leap > JUMP * last_leap;
            }
            (*reached, increment, last_leap) = (arrived, 2.0 * increment, 0.0);
            if at == to {
                let status = self.status(sheet, &minimum, jumped);
                let works = self.works(&minimum.state.configuration);
                let tangent = StepTangent {
                    values: minimum.tangent,
                    factor: minimum.factor,
                };
                return LoadStep::new(
                    sheet,
                    minimum.state,
                    works,
                    Some(tangent),
                    status,
                    iterations,
                );
            }
        }
    }

    /// Whether a state under the loads at `at` lies above the one before, left as it was: no sheet gets there by
    /// itself. Not known where supports or stroke move it.
    fn climbed(&self, reached: &Reached, at: f64, state: &State) -> bool {
        if self.drive.is_some() || self.supports.iter().any(|support| support.value != 0.0) {
            return false;
        }
        let [work, held] = self.works(&reached.configuration);
        let before = reached.stored - at * work - held;
        state.potential - before > LEVEL * state.magnitude
    }

    /// The last point of a path that could not be followed further.
    fn diverged(
        &self,
        sheet: HingedSheet,
        reached: &Reached,
        residual: f64,
        iterations: usize,
    ) -> LoadStep {
        let potential = self.potential(sheet, reached.at, reached.force);
        let state = potential.state(reached.configuration.clone());
        let state = state.expect("this state has been computed before");
        let works = self.works(&reached.configuration);
        let step = LoadStep::new(sheet, state, works, None, Status::Diverged, iterations);
        LoadStep { residual, ..step }
    }

    fn status(&self, sheet: HingedSheet, minimum: &Minimum, jumped: bool) -> Status {
        let stable = (minimum.factor.as_ref()).is_some_and(|held| held.unstable_directions() == 0);
        let law = sheet.law;
        if jumped {
            Status::LimitPoint
        } else if !minimum.state.is_balanced(self.settings.tolerance) || !stable {
            Status::Almost
        } else if law.inside(&minimum.state.deformations()).contains(&false) {
            Status::LeftDomain
        } else {
            Status::Converged
        }
    }

    /// The potential at a point of the path.
    fn potential<'a>(&'a self, sheet: HingedSheet<'a>, at: f64, force: f64) -> Potential<'a> {
        let area: f64 = sheet.sheet.panels.iter().map(Panel::area).sum();
        Potential {
            sheet,
            pattern: &self.pattern,
            free: &self.free,
            control: match &self.drive {
                None => Control::Load(at),
                Some((stroke, _)) => Control::Stroke(stroke),
            },
            loads: &self.loads,
            held: &self.held,
            force,
            panel_size: (area / sheet.sheet.panels.len() as f64).sqrt(),
        }
    }

    /// Where the rates at `reached` lead, configuration and hinge forces, the supports and the stroke as
    /// they are at `at`; under load control no further than the part `reach` of the way.
    fn predicted(&self, reached: &Reached, at: f64, reach: f64) -> (Configuration, Vec<[f64; 3]>) {
        let ahead = at - reached.at;
        // A stroke is kept whatever the rotation.
        let cut = match self.drive {
            None => (LONGEST_INCREMENT / (ahead * reached.speed)).min(reach),
            Some(_) => 1.0,
        };
        let mut configuration = moved(&reached.configuration, &reached.rate, cut * ahead);
        let forces = moved(&reached.forces, &reached.force_rates, cut * ahead);
        for support in &self.supports {
            let (panel, dof) = (support.panel, support.dof.index());
            configuration[panel][dof] = reached.configuration[panel][dof] + ahead * support.value;
        }
        (configuration, forces)
    }

    /// The rate of the configuration along the path. Where the tangent is singular only supports and
    /// stroke move.
    fn rate(
        &self,
        potential: &Potential,
        state: &State,
        factor: Option<&HeldFactor>,
    ) -> Vec<[f64; 3]> {
        let mut supports = vec![[0.0; 3]; self.grid.panel_count()];
        for support in &self.supports {
            supports[support.panel][support.dof.index()] = support.value;
        }
        let moving = supports.as_flattened().iter().any(|way| *way != 0.0);
        let resisted = match moving {
            true => potential.resistance(state, &supports),
            false => vec![[0.0; 3]; supports.len()],
        };
        let (loads, stroke) = match &self.drive {
            None => (1.0, 0.0),
            Some((_, stroke)) => (0.0, *stroke),
        };
        let b: Vec<[f64; 3]> = std::iter::zip(&self.loads, resisted)
            .map(|(load, resisted)| std::array::from_fn(|d| loads * load[d] - resisted[d]))
            .collect();
        let free = match (factor, &self.drive) {
            (Some(factor), _) => {
                let b = gather(&self.free, &b);
                factor.solve_bordered(&self.pattern, &b, stroke).0
            }
            (None, Some((direction, _))) => direction.motion(stroke),
            (None, None) => vec![0.0; self.free.iter().flatten().count()],
        };
        let mut rate = spread(&self.free, &free);
        for (rate, support) in std::iter::zip(rate.as_flattened_mut(), supports.as_flattened()) {
            *rate += support;
        }
        rate
    }

    /// The greatest rotation (rad) between two points of the path, if the rates at them do not explain
    /// it and it is worth a look.
    fn leap(&self, from: &Reached, to: &Reached, unstable: bool) -> Option<f64> {
        let ahead = to.at - from.at;
        let (mut turned, mut unexplained) = (0.0_f64, 0.0_f64);
        for k in 0..from.configuration.len() {
            let turn = to.configuration[k][2] - from.configuration[k][2];
            let mean = 0.5 * (from.rate[k][2] + to.rate[k][2]);
            turned = turned.max(turn.abs());
            unexplained = unexplained.max((turn - mean * ahead).abs());
        }
        let speed = if from.faster {
            to.speed
        } else {
            from.speed.max(to.speed)
        };
        let leaps = turned > self.settings.least_leap
            && unexplained > UNEXPLAINED * turned
            && (unstable || turned > AHEAD_OF_RATE * speed * ahead);
        leaps.then_some(turned)
    }

    /// Work of the full loads and of those that are held (N mm).
    fn works(&self, configuration: &[[f64; 3]]) -> [f64; 2] {
        [&self.loads, &self.held].map(|loads| {
            std::iter::zip(loads.as_flattened(), configuration.as_flattened())
                .map(|(f, q)| f * q)
                .sum()
        })
    }
}
