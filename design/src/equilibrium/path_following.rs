//! Following the equilibrium path, from the flat sheet or from the end of another path.
//!
//! An increment is predicted with the tangent at its beginning and corrected to a minimum. It is halved
//! until a minimum is found and the rates at its ends explain the rotations,
//!
//! ```text
//! |dphi - (phi'_0 + phi'_1) dt / 2| <= |dphi| / 2,     or     |dphi| <= 3/2 |phi'| dt at one end
//! ```
//!
//! The second condition is sufficient if no tangent of the increment was indefinite, and at an end towards which
//! the rate decreases: towards a limit point the rate grows without bound. A rotation that does not decrease with
//! the increment is a jump past a limit point.

use crate::equilibrium::displacement_control::HeldFactor;
use crate::equilibrium::hinged_sheet::HingedSheet;
use crate::equilibrium::load_step::{LoadStep, Status, StepTangent};
use crate::equilibrium::newton::{LEVEL, Minimum};
use crate::equilibrium::potential::{Control, Potential, State, moved};
use crate::equilibrium::settings::{Method, SolverSettings};
use crate::equilibrium::solver::{EquilibriumError, EquilibriumSolver};
use crate::equilibrium::supports::{Load, Support};
use crate::sheet::cut_sheet::Panel;
use crate::sheet::kinematics::Configuration;
use crate::sheet::panel_vectors::{gather, spread};

/// Maximum rotation (rad) of an increment, predicted by the rate at its beginning.
const LONGEST_INCREMENT: f64 = 0.2;
/// Fraction of a rotation that the rates at both ends may leave unexplained.
const UNEXPLAINED: f64 = 0.5;
/// Maximum ratio of the rotation on a continuous path to that predicted by the rate at one end.
const AHEAD_OF_RATE: f64 = 1.5;
/// A rotation is a jump if halving the increment leaves more than this fraction of it; the fraction is 1 at a fold
/// and 0.7 on a path that branches off like a square root.
const JUMP: f64 = 0.8;

/// A point on the path.
struct Reached {
    /// Fraction of the loads, the stroke and the support motions.
    at: f64,
    configuration: Configuration,
    /// Rate of the configuration.
    rate: Vec<[f64; 3]>,
    /// Energy of the hinges (N mm).
    stored: f64,
    /// Forces of the hinges, and their rates.
    forces: Vec<[f64; 3]>,
    force_rates: Vec<[f64; 3]>,
    /// Maximum rate of rotation (rad).
    speed: f64,
    /// Whether the rate of rotation grew in the last increment.
    faster: bool,
    /// Maximum force so far; under load control that of the full load (N).
    force: f64,
}

impl EquilibriumSolver {
    /// The solver of a path that follows the state `last` of this solver's path: the supports remain where they are,
    /// its loads are held constant, and `loads` are added in `steps` steps. The new path begins at the
    /// configuration of `last`; the adjoint does not apply to it.
    pub fn followed_by(
        &self,
        last: &LoadStep,
        loads: &[Load],
        steps: usize,
    ) -> Result<Self, EquilibriumError> {
        let still = |&support: &Support| Support {
            value: 0.0,
            ..support
        };
        let supports: Vec<Support> = self.supports.iter().map(still).collect();
        let next = Self::new(self.grid, &supports, loads, steps, self.settings)?;
        let held = std::iter::zip(&self.held, &self.loads);
        Ok(Self {
            held: held
                .map(|(held, load)| std::array::from_fn(|d| held[d] + last.load_factor * load[d]))
                .collect(),
            ..next
        })
    }

    /// Follows the equilibrium path from the flat sheet. The path ends early if a step diverges.
    ///
    /// # Panics
    /// If the grids of sheet and solver differ.
    pub fn path(&self, sheet: HingedSheet) -> Vec<LoadStep> {
        self.path_from(sheet, vec![[0.0; 3]; self.grid.panel_count()])
    }

    /// Follows the equilibrium path from a start that is an equilibrium without the loads of this solver; for a
    /// solver that follows another, from the end of that solver's path.
    ///
    /// # Panics
    /// If the sheet or the start has another grid than the solver.
    pub fn path_from(&self, sheet: HingedSheet, start: Configuration) -> Vec<LoadStep> {
        assert_eq!(
            self.grid, sheet.sheet.grid,
            "the grids of solver and sheet must be the same"
        );
        assert_eq!(start.len(), self.grid.panel_count(), "one motion per panel");
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

    /// The start of the path; `None` if the energy is not finite there.
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

    /// A point of the path; `speed_before` is the rate of rotation at the point before.
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

    /// The load step to `to`, in as many increments as necessary; updates `reached`.
    fn advance(&self, sheet: HingedSheet, reached: &mut Reached, to: f64) -> LoadStep {
        let mut increment = to - reached.at;
        let least = increment * 0.5_f64.powi(self.settings.max_halvings as i32);
        let (mut iterations, mut jumped, mut last_leap) = (0, false, 0.0);
        loop {
            increment = (to - reached.at)
                .min(increment)
                .min((LONGEST_INCREMENT / reached.speed).max(least));
            // The last increment ends exactly at `to`, so that rounding leaves no remainder.
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
                // If the prediction makes panels pass through each other or crosses a ridge of the energy, the
                // search restarts from the last configuration.
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

    /// Whether a state under the loads at `at` has more energy than the previous configuration, which a sheet cannot
    /// reach by itself. Not tested if supports move or a stroke is prescribed.
    fn climbed(&self, reached: &Reached, at: f64, state: &State) -> bool {
        if self.drive.is_some() || self.supports.iter().any(|support| support.value != 0.0) {
            return false;
        }
        let [work, held] = self.works(&reached.configuration);
        let before = reached.stored - at * work - held;
        state.potential - before > LEVEL * state.magnitude
    }

    /// The last point of a path that could not be continued.
    fn diverged(
        &self,
        sheet: HingedSheet,
        reached: &Reached,
        residual: f64,
        iterations: usize,
    ) -> LoadStep {
        let potential = self.potential(sheet, reached.at, reached.force);
        let state = potential.state(reached.configuration.clone());
        let state = state.expect("this state was computed before");
        let works = self.works(&reached.configuration);
        let step = LoadStep::new(sheet, state, works, None, Status::Diverged, iterations);
        LoadStep { residual, ..step }
    }

    fn status(&self, sheet: HingedSheet, minimum: &Minimum, jumped: bool) -> Status {
        let stable = (minimum.factor.as_ref()).is_some_and(|held| held.unstable_directions() == 0);
        let law = sheet.law;
        let SolverSettings {
            tolerance,
            loose_tolerance,
            ..
        } = self.settings;
        // Rounding may explain a residual above the loose tolerance; it is no converged state nevertheless.
        let balanced =
            minimum.state.is_balanced(tolerance) && minimum.state.residual <= loose_tolerance;
        if jumped {
            Status::LimitPoint
        } else if !balanced || !stable {
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

    /// The configuration and hinge forces predicted by the rates at `reached`, with the supports and the stroke at
    /// their values at `at`; under load control at most the fraction `reach` of the increment.
    fn predicted(&self, reached: &Reached, at: f64, reach: f64) -> (Configuration, Vec<[f64; 3]>) {
        let ahead = at - reached.at;
        // A prescribed stroke is kept whatever the rotation.
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

    /// The rate of the configuration along the path. If the tangent is singular, only the rates of supports and
    /// stroke are non-zero.
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

    /// The maximum rotation (rad) between two points of the path, if it is larger than `least_leap` and the rates do
    /// not explain it.
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

    /// Work of the full loads and of the loads held constant (N mm).
    fn works(&self, configuration: &[[f64; 3]]) -> [f64; 2] {
        [&self.loads, &self.held].map(|loads| {
            std::iter::zip(loads.as_flattened(), configuration.as_flattened())
                .map(|(f, q)| f * q)
                .sum()
        })
    }
}
