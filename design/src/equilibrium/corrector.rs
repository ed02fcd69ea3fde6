//! Equilibria on a branch of the path: prediction corrected by Newton's method, in the plane normal
//! to the path or at a given load.
//!
//! Let d_0 be the correction at constant load, q' the rate with the load and p the rate along the
//! path, the correction in the plane is
//!
//! ```text
//! d = d_0 + dt q',     dt = -(p . d_0) / (p . q')
//! ```
//!
//! which is regular where the load has a maximum along the path. One factorisation serves as many
//! corrections as it contracts fast enough.

use crate::{
    equilibrium::{
        displacement_control::HeldFactor,
        load_step::StepTangent,
        newton::Minimum,
        potential::{Branch, PathStage, PotentialState, moved},
        predictor::PathPoint,
    },
    hinge_law::Order,
    sheet::kinematics::Motion,
};

/// Maximum number of corrections.
const CORRECTIONS: usize = 10;
/// Ratio of two successive corrections above which the tangent is factorised again.
const CONTRACTION: f64 = 0.1;
/// Ratio of two successive corrections by a new tangent above which the corrections do not
/// converge.
const DIVERGENCE: f64 = 0.5;
/// Expected length of the next correction (rad, or panel sizes) from which it is not needed to
/// follow the path. Stiff hinges amplify the error of the hinge forces.
const CLOSE: f64 = 1e-8;
/// Expected length of the next correction below which a balanced state is as smooth in the design
/// as rounding allows.
const EXACT: f64 = 1e-13;
/// Length of the first correction of a load step (rad, or panel sizes) up to which the factors of
/// the predicted tangent are kept.
const NEAR: f64 = 1e-4;
/// Relative change of a rate below which it is not refined further, and the maximum number of
/// refinements.
const RATE: (f64, usize) = (1e-3, 3);

/// An equilibrium close enough to the path to follow it.
pub(crate) struct Corrected {
    pub position: PathPoint,
    /// The state at the position, the factors of a tangent near it, and the rate with the load
    /// parameter by them.
    pub state: PotentialState,
    pub factor: HeldFactor,
    pub rate: Vec<Motion>,
    /// Length of the first correction: the error of the prediction (rad, or panel sizes).
    pub error: f64,
}

struct Linearised {
    state: PotentialState,
    values: Vec<f64>,
    factor: HeldFactor,
}

struct NewtonCorrection {
    at: f64,
    motion: Vec<Motion>,
    /// rad, or panel sizes
    length: f64,
}

pub(crate) struct Waypoint {
    pub position: PathPoint,
    /// The rate along the path; the fastest hinge moves by one (rad, or panel sizes).
    pub rate: PathPoint,
    /// Maximum rate of rotation (rad).
    pub turning: f64,
    /// Factors of a tangent near the position.
    pub factor: Option<HeldFactor>,
}

impl Waypoint {
    /// A position without a known rate: from there the path goes on by its load parameter.
    pub(crate) fn still(position: PathPoint) -> Self {
        let rate = PathPoint {
            at: 1.0,
            configuration: vec![[0.0; 3]; position.configuration.len()],
            forces: vec![[0.0; 3]; position.forces.len()],
        };
        Self { position, rate, turning: 0.0, factor: None }
    }

    pub(crate) fn is_still(&self) -> bool {
        self.rate.configuration.as_flattened().iter().all(|rate| *rate == 0.0)
    }
}

impl Branch<'_> {
    /// Moves supports and stroke of a position to their values at its load parameter; their values
    /// in `known` must be right.
    pub(crate) fn hold(&self, position: &mut PathPoint, known: &PathPoint) {
        let ahead = match self.stage {
            PathStage::Weight => 0.0,
            PathStage::Actuation => position.at - known.at,
        };
        for support in &self.solver.supports {
            let (panel, dof) = (support.panel, support.dof.index());
            position.configuration[panel][dof] =
                known.configuration[panel][dof] + ahead * support.value;
        }
        if let Some((stroke, full)) = &self.solver.drive {
            let of = |position: &PathPoint| {
                stroke.of(&self.solver.pattern.gather(&position.configuration))
            };
            let short = of(known) + ahead * full - of(position);
            let motion = self.solver.pattern.spread(&stroke.motion(short));
            position.configuration = moved(&position.configuration, &motion, 1.0);
        }
    }

    /// The equilibrium near a predicted position: in the plane normal to the rate `normal`, or at
    /// the load of the position. Otherwise the error of the prediction if that is larger than
    /// `limit`, infinite if the corrections do not converge.
    pub(crate) fn close(
        &mut self,
        mut position: PathPoint,
        normal: Option<&PathPoint>,
        limit: f64,
    ) -> Result<Corrected, f64> {
        const DIVERGED: f64 = f64::INFINITY;
        let (mut error, mut before) = (None, DIVERGED);
        for _ in 0..CORRECTIONS {
            let near = self.state_at(&position, Order::Tangent).and_then(|state| {
                let expected = Some(position.forces.clone());
                self.linearised(PotentialState { expected, ..state })
            });
            let mut near = near.ok_or(DIVERGED)?;
            let rate = self.rate(&near.state, &near.factor);
            let in_plane = normal.map(|normal| (&rate[..], normal));
            let mut last = self.correction(&near.state, &near.factor, in_plane);
            if last.length.is_nan() || last.length > DIVERGENCE * before {
                return Err(DIVERGED);
            }
            let error = *error.get_or_insert(last.length);
            if error > limit {
                return Err(error);
            }
            before = last.length;
            position = self.corrected(&near.state, &last);
            // The other corrections need only the forces of the hinges.
            let mut next = before;
            while next > CLOSE {
                let state = self.state_at(&position, Order::Forces).ok_or(DIVERGED)?;
                near.state = state.with_stiffness_of(&near.state);
                let again = self.correction(&near.state, &near.factor, in_plane);
                if again.length.is_nan() || again.length > CONTRACTION * last.length {
                    break;
                }
                position = self.corrected(&near.state, &again);
                next = again.length * again.length / last.length;
                last = again;
            }
            if next <= CLOSE {
                let state = self.state_at(&position, Order::Tangent).ok_or(DIVERGED)?;
                return Ok(Corrected {
                    position: PathPoint { forces: state.forces(), ..position },
                    state,
                    factor: near.factor,
                    rate,
                    error,
                });
            }
        }
        Err(DIVERGED)
    }

    /// The equilibrium near a predicted position, at its load, with a residual within the
    /// tolerance.
    pub(crate) fn balanced(&mut self, mut position: PathPoint) -> Option<Minimum> {
        let tolerance = self.solver.settings.tolerance;
        let mut before = f64::INFINITY;
        for _ in 0..CORRECTIONS {
            let mut state = self.state_at(&position, Order::Tangent)?;
            if state.is_balanced(tolerance) {
                return self.linearised(state).map(Minimum::from);
            }
            state.expected = Some(position.forces.clone());
            let mut near = self.linearised(state)?;
            let first = self.correction(&near.state, &near.factor, None);
            if first.length.is_nan() || first.length > DIVERGENCE * before {
                return None;
            }
            before = first.length;
            let mut next = before * before;
            let mut last = first;
            let mut polished = false;
            position = self.corrected(&near.state, &last);
            for _ in 0..CORRECTIONS {
                // One more correction makes a balanced state as smooth in the design as rounding
                // allows.
                let ready = polished || next <= EXACT;
                let order = if !ready {
                    Order::Forces
                } else if self.sheet.damage_gradient {
                    Order::Design
                } else {
                    Order::Tangent
                };
                let mut state = self.state_at(&position, order)?;
                state.rounding = state.rounding.max(near.state.rounding);
                let balanced = state.is_balanced(tolerance);
                if balanced && ready {
                    // Factors of a tangent this close serve as its own, after refinement.
                    if before > NEAR {
                        return self.linearised(state).map(Minimum::from);
                    }
                    let values = self.tangent(&state);
                    return Some(Linearised { state, values, ..near }.into());
                }
                polished = balanced;
                let again = self.correction(&state, &near.factor, None);
                if again.length.is_nan() || (!balanced && again.length > CONTRACTION * last.length)
                {
                    break;
                }
                near.state = state.with_stiffness_of(&near.state);
                position = self.corrected(&near.state, &again);
                next = again.length * again.length / last.length;
                last = again;
            }
        }
        None
    }

    fn linearised(&mut self, state: PotentialState) -> Option<Linearised> {
        let StepTangent { values, factor } = self.factorised(&state);
        Some(Linearised { state, values, factor: factor? })
    }

    /// The correction of a state by factors: with the rate with the load parameter in the plane
    /// normal to the path, or at constant load.
    fn correction(
        &mut self,
        state: &PotentialState,
        factor: &HeldFactor,
        in_plane: Option<(&[Motion], &PathPoint)>,
    ) -> NewtonCorrection {
        let direct = self.direct(state, factor);
        let (motion, at) = match in_plane {
            Some((rate, normal)) => self.in_plane(&direct, rate, normal),
            None => (direct, 0.0),
        };
        let length = self.length(state, &motion);
        self.effort.iterations += usize::from(length > 0.0);
        NewtonCorrection { at, motion, length }
    }

    fn corrected(&self, state: &PotentialState, by: &NewtonCorrection) -> PathPoint {
        let rates = self.force_rates(state, &by.motion);
        PathPoint {
            at: state.at + by.at,
            configuration: moved(&state.configuration, &by.motion, 1.0),
            forces: moved(&state.forces(), &rates, 1.0),
        }
    }

    /// The correction d_0 of a state at constant load.
    pub(crate) fn direct(&self, state: &PotentialState, factor: &HeldFactor) -> Vec<Motion> {
        let downhill: Vec<f64> = state.gradient.iter().map(|g| -g).collect();
        let pattern = &self.solver.pattern;
        pattern.spread(&factor.solve(pattern, &downhill))
    }

    /// The correction in the plane normal to the path, and the correction of the load parameter.
    pub(crate) fn in_plane(
        &self,
        direct: &[Motion],
        rate: &[Motion],
        normal: &PathPoint,
    ) -> (Vec<Motion>, f64) {
        let along = |motion: &[Motion]| self.product(&normal.configuration, motion);
        let dt = -along(direct) / along(rate);
        (moved(direct, rate, dt), dt)
    }

    /// The product of two motions; lengths are divided by the size of a panel.
    pub(crate) fn product(&self, a: &[Motion], b: &[Motion]) -> f64 {
        let scale = 1.0 / (self.panel_size * self.panel_size);
        std::iter::zip(a, b)
            .map(|([ax, ay, phi], [bx, by, psi])| scale * (ax * bx + ay * by) + phi * psi)
            .sum()
    }

    /// The point of the branch at a corrected position, seen along the rate `before`.
    pub(crate) fn point(&self, corrected: Corrected, before: Option<&PathPoint>) -> Waypoint {
        let Corrected { position, state, factor, rate, .. } = corrected;
        let rate = self.refined_rate(&state, &factor, rate);
        let size = self.length(&state, &rate);
        // A path without any motion is followed by its load parameter.
        let size = if size > 0.0 { size } else { 1.0 };
        // A stable branch goes on to higher loads, however sharply it turns where hinges lock;
        // beyond a limit point the path goes on in the direction in which it came.
        let backwards = before.is_some_and(|before| {
            !factor.is_stable() && self.product(&before.configuration, &rate) < 0.0
        });
        let scale = if backwards { -1.0 / size } else { 1.0 / size };
        let forces = self.force_rates(&state, &rate);
        let rate = PathPoint { at: 1.0, configuration: rate, forces };
        let rate = PathPoint::sum([(scale, &rate)]);
        let turning = |most: f64, rate: &Motion| rate[2].abs().max(most);
        Waypoint {
            turning: rate.configuration.iter().fold(0.0, turning),
            rate,
            position,
            factor: Some(factor),
        }
    }

    /// A rate with the load parameter, refined by products with the tangent of the state.
    fn refined_rate(
        &self,
        state: &PotentialState,
        factor: &HeldFactor,
        mut rate: Vec<Motion>,
    ) -> Vec<Motion> {
        let pattern = &self.solver.pattern;
        let driving = self.driving(state);
        for _ in 0..RATE.1 {
            let resisted = self.resistance(state, &rate);
            let missing = moved(&driving, &resisted, -1.0);
            let change = pattern.spread(&factor.solve(pattern, &pattern.gather(&missing)));
            let [before, by] = [&rate, &change].map(|motion| self.length(state, motion));
            rate = moved(&rate, &change, 1.0);
            if by <= RATE.0 * before {
                break;
            }
        }
        rate
    }

    /// The rate of the configuration with the load parameter.
    pub(crate) fn rate(&self, state: &PotentialState, factor: &HeldFactor) -> Vec<Motion> {
        let solver = self.solver;
        let (supports, stroke) = if self.stage == PathStage::Actuation {
            let stroke = solver.drive.as_ref().map_or(0.0, |(_, stroke)| *stroke);
            (solver.support_motions(), stroke)
        } else {
            (vec![[0.0; 3]; solver.topology.panel_count()], 0.0)
        };
        let mut b = self.driving(state);
        if supports.as_flattened().iter().any(|motion| *motion != 0.0) {
            b = moved(&b, &self.resistance(state, &supports), -1.0);
        }
        let b = solver.pattern.gather(&b);
        let (free, _) = factor.solve_bordered(&solver.pattern, &b, stroke);
        moved(&supports, &solver.pattern.spread(&free), 1.0)
    }
}

impl From<Linearised> for Minimum {
    fn from(near: Linearised) -> Self {
        let tangent = StepTangent { values: near.values, factor: Some(near.factor) };
        Self { state: near.state, tangent }
    }
}
