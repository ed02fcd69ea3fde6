//! Equilibria on a branch of the path: prediction corrected by Newton's method, in the plane normal to the path or at a
//! given load.
//!
//! With d_0 the correction at constant load, q' the rate with the load and p the rate along the path, the
//! correction in the plane is
//!
//! ```text
//! d = d_0 + dt q',     dt = -(p . d_0) / (p . q')
//! ```
//!
//! which is regular where the load has a maximum along the path. One factorisation serves as many corrections as it
//! contracts fast enough.

use crate::equilibrium::displacement_control::HeldFactor;
use crate::equilibrium::hinged_sheet::HingedSheet;
use crate::equilibrium::load_step::Effort;
use crate::equilibrium::place::Place;
use crate::equilibrium::potential::{Control, Potential, State, moved};
use crate::equilibrium::solver::EquilibriumSolver;
use crate::sheet::cut_sheet::Panel;
use crate::sheet::panel_vectors::{gather, spread};

/// Maximum number of corrections.
const CORRECTIONS: usize = 10;
/// Ratio of two successive corrections above which the tangent is factorised again.
const CONTRACTION: f64 = 0.1;
/// Ratio of two successive corrections by a new tangent above which the corrections do not converge.
const DIVERGENCE: f64 = 0.5;
/// Expected length of the next correction (rad, or panel sizes) from which it is not needed to follow the path. Stiff
/// hinges amplify the error of the hinge forces.
const CLOSE: f64 = 1e-8;
/// Length of the first correction (rad, or panel sizes) up to which the factors of the predicted tangent are kept.
const NEAR: f64 = 1e-4;
/// Relative change of a rate below which it is not refined further, and the maximum number of refinements.
const RATE: (f64, usize) = (1e-3, 3);

/// The equilibria of a sheet under the loads, stroke and support motions of a solver.
pub(crate) struct Branch<'a> {
    pub solver: &'a EquilibriumSolver,
    pub sheet: HingedSheet<'a>,
    /// Lower bound of the force that residuals are relative to (N).
    pub force: f64,
    pub panel_size: f64,
    /// Counts what the branch costs.
    pub effort: Effort,
}

/// Where the corrections end.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Until {
    /// Close enough to follow the path.
    Close,
    /// Residual within the tolerance.
    Balanced,
}

/// A corrected place.
pub(crate) struct Corrected {
    pub at: f64,
    pub state: State,
    /// A tangent near the state, and its factors; of a balanced state its own.
    pub values: Vec<f64>,
    pub factor: HeldFactor,
    /// Length of the first correction: the error of the prediction (rad, or panel sizes).
    pub error: f64,
}

/// A tangent, its factors, and the rate of the configuration with the load parameter by them.
struct Held {
    values: Vec<f64>,
    factor: HeldFactor,
    rate: Option<Vec<[f64; 3]>>,
}

/// A point of the branch.
#[derive(Clone)]
pub(crate) struct Point {
    pub place: Place,
    /// The rate along the path; the fastest hinge moves by one (rad, or panel sizes).
    pub rate: Place,
    /// Maximum rate of rotation (rad).
    pub turning: f64,
}

impl Point {
    /// A place without a known rate: from there the path goes on by its load parameter.
    pub fn still(place: Place) -> Self {
        let rate = Place {
            at: 1.0,
            configuration: vec![[0.0; 3]; place.configuration.len()],
            forces: vec![[0.0; 3]; place.forces.len()],
        };
        Self {
            place,
            rate,
            turning: 0.0,
        }
    }

    pub fn is_still(&self) -> bool {
        self.rate
            .configuration
            .as_flattened()
            .iter()
            .all(|rate| *rate == 0.0)
    }
}

impl<'a> Branch<'a> {
    pub fn new(solver: &'a EquilibriumSolver, sheet: HingedSheet<'a>) -> Self {
        let area: f64 = sheet.sheet.panels.iter().map(Panel::area).sum();
        let mut branch = Self {
            solver,
            sheet,
            force: 0.0,
            panel_size: (area / sheet.sheet.panels.len() as f64).sqrt(),
            effort: Effort::default(),
        };
        if solver.drive.is_none() {
            let loads = solver.loads.iter().copied();
            branch.force = branch.potential(0.0).greatest(loads);
        }
        branch
    }

    /// The potential at a point of the path.
    pub fn potential(&self, at: f64) -> Potential<'a> {
        Potential {
            sheet: self.sheet,
            pattern: &self.solver.pattern,
            free: &self.solver.free,
            control: match &self.solver.drive {
                None => Control::Load(at),
                Some((stroke, _)) => Control::Stroke(stroke),
            },
            loads: &self.solver.loads,
            held: &self.solver.held,
            force: self.force,
            panel_size: self.panel_size,
        }
    }

    /// Moves supports and stroke of a place to their values at its load parameter, those of `known` being right.
    pub fn hold(&self, place: &mut Place, known: &Place) {
        let ahead = place.at - known.at;
        for support in &self.solver.supports {
            let (panel, dof) = (support.panel, support.dof.index());
            place.configuration[panel][dof] =
                known.configuration[panel][dof] + ahead * support.value;
        }
        if let Some((stroke, full)) = &self.solver.drive {
            let of = |place: &Place| stroke.of(&gather(&self.solver.free, &place.configuration));
            let short = of(known) + ahead * full - of(place);
            let motion = spread(&self.solver.free, &stroke.motion(short));
            place.configuration = moved(&place.configuration, &motion, 1.0);
        }
    }

    /// The equilibrium near a predicted place: in the plane normal to the rate `normal`, or at the place's load.
    /// `None` if the corrections do not converge, or if the first is longer than `limit`.
    pub fn corrected(
        &mut self,
        mut place: Place,
        normal: Option<&Place>,
        until: Until,
        limit: f64,
    ) -> Option<Corrected> {
        let mut held: Option<Held> = None;
        let (mut error, mut last) = (0.0, f64::INFINITY);
        let mut polished = false;
        for round in 0..CORRECTIONS {
            let potential = self.potential(place.at);
            let mut state = potential.state(std::mem::take(&mut place.configuration))?;
            let balanced =
                until == Until::Balanced && state.is_balanced(self.solver.settings.tolerance);
            if balanced && (polished || held.is_none()) {
                // Factors of a tangent this close serve as its own, after refinement.
                let (values, factor) = match held {
                    Some(held) if error <= NEAR => (potential.tangent(&state), Some(held.factor)),
                    held => self.factor(&potential, &state, held.map(|held| held.factor)),
                };
                return Some(Corrected {
                    at: place.at,
                    state,
                    values,
                    factor: factor?,
                    error,
                });
            }
            // One more correction by the same factors makes the state as smooth in the design as rounding allows.
            polished = balanced;
            let again =
                (held.as_ref()).map(|held| self.correction(&potential, &state, held, normal));
            let enough = |length: f64| balanced || length <= CONTRACTION * last;
            let contracted = again.filter(|(length, ..)| enough(*length));
            let (length, motion, dt) = match contracted {
                Some(step) => step,
                None => {
                    state.expected = Some(std::mem::take(&mut place.forces));
                    let memory = held.take().map(|held| held.factor);
                    let (values, factor) = self.factor(&potential, &state, memory);
                    let factor = factor?;
                    let rate = normal.map(|_| self.rate(&potential, &state, &factor));
                    let new = held.insert(Held {
                        values,
                        factor,
                        rate,
                    });
                    self.correction(&potential, &state, new, normal)
                }
            };
            if length.is_nan() || (!balanced && length > DIVERGENCE * last) {
                return None;
            }
            if round == 0 {
                error = length;
                if error > limit {
                    return None;
                }
            }
            self.effort.iterations += usize::from(length > 0.0);
            let next = length * length / if round == 0 { 1.0 } else { last };
            last = length;
            place.at += dt;
            place.configuration = moved(&state.configuration, &motion, 1.0);
            let rates = potential.force_rates(&state, &motion);
            place.forces = moved(&state.forces(), &rates, 1.0);
            if until == Until::Close && next <= CLOSE {
                let potential = self.potential(place.at);
                let state = potential.state(place.configuration)?;
                let held = held?;
                return Some(Corrected {
                    at: place.at,
                    state,
                    values: held.values,
                    factor: held.factor,
                    error,
                });
            }
        }
        None
    }

    /// The tangent of a state and its factors, stored in the memory of earlier ones.
    pub fn factor(
        &mut self,
        potential: &Potential,
        state: &State,
        memory: Option<HeldFactor>,
    ) -> (Vec<f64>, Option<HeldFactor>) {
        self.effort.factorisations += 1;
        let memory = memory.map_or(Vec::new(), |held| held.factor.values);
        let values = potential.tangent(state);
        let factor = potential.factorise(&values, memory);
        (values, factor)
    }

    /// The length of a correction, and the correction of the configuration and of the load parameter.
    fn correction(
        &self,
        potential: &Potential,
        state: &State,
        held: &Held,
        normal: Option<&Place>,
    ) -> (f64, Vec<[f64; 3]>, f64) {
        let direct = self.direct(state, &held.factor);
        let (motion, dt) = match (normal, &held.rate) {
            (Some(normal), Some(rate)) => self.in_plane(&direct, rate, normal),
            _ => (direct, 0.0),
        };
        (potential.length(state, &motion), motion, dt)
    }

    /// The correction d_0 of a state at constant load.
    pub fn direct(&self, state: &State, factor: &HeldFactor) -> Vec<[f64; 3]> {
        let downhill: Vec<f64> = state.gradient.iter().map(|g| -g).collect();
        spread(
            &self.solver.free,
            &factor.solve(&self.solver.pattern, &downhill),
        )
    }

    /// The correction in the plane normal to the path, and that of the load parameter.
    pub fn in_plane(
        &self,
        direct: &[[f64; 3]],
        rate: &[[f64; 3]],
        normal: &Place,
    ) -> (Vec<[f64; 3]>, f64) {
        let along = |motion: &[[f64; 3]]| self.product(&normal.configuration, motion);
        let dt = -along(direct) / along(rate);
        (moved(direct, rate, dt), dt)
    }

    /// The product of two motions; lengths are divided by the size of a panel.
    pub fn product(&self, a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
        let scale = 1.0 / (self.panel_size * self.panel_size);
        std::iter::zip(a, b)
            .map(|([ax, ay, phi], [bx, by, psi])| scale * (ax * bx + ay * by) + phi * psi)
            .sum()
    }

    /// The point of the branch at a corrected place, seen along the rate `before`, and the factors used.
    pub fn point(&self, corrected: Corrected, before: Option<&Place>) -> (Point, HeldFactor) {
        let Corrected {
            at, state, factor, ..
        } = corrected;
        let potential = self.potential(at);
        let rate = self.refined_rate(&potential, &state, &factor);
        let size = potential.length(&state, &rate);
        // Without any motion the path is followed by its load parameter.
        let size = if size > 0.0 { size } else { 1.0 };
        let backwards =
            before.is_some_and(|before| self.product(&before.configuration, &rate) < 0.0);
        let scale = if backwards { -1.0 / size } else { 1.0 / size };
        let forces = potential.force_rates(&state, &rate);
        let rate = Place {
            at: 1.0,
            configuration: rate,
            forces,
        };
        let rate = Place::sum([(scale, &rate)]);
        let turning = |most: f64, rate: &[f64; 3]| rate[2].abs().max(most);
        let point = Point {
            turning: rate.configuration.iter().fold(0.0, turning),
            rate,
            place: Place {
                at,
                forces: state.forces(),
                configuration: state.configuration,
            },
        };
        (point, factor)
    }

    /// The rate with the load parameter, by factors of a tangent near the state and products with its own.
    fn refined_rate(
        &self,
        potential: &Potential,
        state: &State,
        factor: &HeldFactor,
    ) -> Vec<[f64; 3]> {
        let free = &self.solver.free;
        let mut rate = self.rate(potential, state, factor);
        for _ in 0..RATE.1 {
            let resisted = potential.resistance(state, &rate);
            let missing: Vec<[f64; 3]> = match &self.solver.drive {
                None => std::iter::zip(&self.solver.loads, &resisted)
                    .map(|(load, resisted)| std::array::from_fn(|d| load[d] - resisted[d]))
                    .collect(),
                Some(_) => resisted.iter().map(|force| force.map(|f| -f)).collect(),
            };
            let change = factor.solve(&self.solver.pattern, &gather(free, &missing));
            let change = spread(free, &change);
            let [before, by] = [&rate, &change].map(|motion| potential.length(state, motion));
            rate = moved(&rate, &change, 1.0);
            if by <= RATE.0 * before {
                break;
            }
        }
        rate
    }

    /// The rate of the configuration with the load parameter.
    fn rate(&self, potential: &Potential, state: &State, factor: &HeldFactor) -> Vec<[f64; 3]> {
        let solver = self.solver;
        let mut supports = vec![[0.0; 3]; solver.grid.panel_count()];
        for support in &solver.supports {
            supports[support.panel][support.dof.index()] = support.value;
        }
        let (loads, stroke) = match &solver.drive {
            None => (1.0, 0.0),
            Some((_, stroke)) => (0.0, *stroke),
        };
        let mut b: Vec<[f64; 3]> = (solver.loads.iter())
            .map(|load| load.map(|load| loads * load))
            .collect();
        if solver.supports.iter().any(|support| support.value != 0.0) {
            b = moved(&b, &potential.resistance(state, &supports), -1.0);
        }
        let b = gather(&solver.free, &b);
        let (free, _) = factor.solve_bordered(&solver.pattern, &b, stroke);
        moved(&supports, &spread(&solver.free, &free), 1.0)
    }
}
