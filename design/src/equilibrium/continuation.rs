//! Following the stable branch of an equilibrium path by its length, and past its limit points.
//!
//! An increment is predicted by the cubic through the last two points and corrected in the plane
//! normal to the path. It is accepted if the equilibrium is stable and the prediction was right to
//! AGREEMENT in every rotation and every hinge translation: a hinge that jumps by more is noticed.
//! Otherwise the increment is shortened. The length of the next increment follows from the error of
//! the prediction.
//!
//! Where an increment shorter than the resolution leads to an unstable equilibrium, the branch has
//! ended: at a limit point, beyond which the load decreases, or at a bifurcation. Dead loads then
//! move the sheet downhill in energy, from the unstable side of the limit point, to another
//! minimum, from which its branch is followed.
//!
//! A learned law has ripples of the size of its error, at which a sheet jumps. Jumps within AGREEMENT
//! are stepped over: the stable equilibrium downhill from the prediction is the next point of the
//! path.
//!
//! The increments do not depend on the load steps, which are read off the path between them.

use crate::{
    equilibrium::{
        corrector::{Corrected, Waypoint},
        displacement_control::HeldFactor,
        hinged_sheet::HingedSheet,
        load_step::DescentEnd,
        newton::{Failure, Minimum},
        potential::{Branch, PathStage, PotentialState, moved},
        predictor::{PathArc, PathPoint, bisected},
        solver::EquilibriumSolver,
    },
    hinge_law::Order,
    sheet::kinematics::Configuration,
};

/// Length of the first increment of a branch. Lengths are in rad, or in panel sizes for hinge
/// translations.
const FIRST: f64 = 0.04;
/// Maximum rotation in an increment (rad).
const TURN: f64 = 0.1;
/// Error of a prediction that increments aim at, and the maximum that is accepted.
const AGREEMENT: [f64; 2] = [1e-3, 4e-3];
/// Distance of the path from the middle of the cubic between two points from which a jump is
/// suspected between them.
const DOUBT: f64 = 1e-3;
/// Range of the ratio of an increment to the last, if that was accepted and if it was rejected.
const GROWTH: [f64; 2] = [0.5, 2.0];
const CUT: [f64; 2] = [0.1, 0.5];
/// The least ratio where the corrections diverge.
const DIVERGED_CUT: f64 = 0.25;
/// Length of an increment up to which a jump may be the reason that none is found.
const SHORT: f64 = 0.01;
/// Resolution of a limit point and of a bifurcation, from which the next branch grows like a square
/// root.
const RESOLVED: [f64; 2] = [1e-3, 1e-5];
/// Maximum number of iterations from an unstable equilibrium to a stable one so near that it is the
/// next one of the path.
const SHORT_DESCENT: usize = 30;
/// Length below which increments are given up.
const SHORTEST: f64 = 1e-9;
/// Parts of the load that are skipped where the path cannot be followed, in the order in which they
/// are tried; then all that is left of the load.
const SKIPPED: [f64; 12] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.03, 0.01, 0.003];
/// Part of the load up to which a jump has led nowhere.
const NOWHERE: f64 = 1e-6;
/// Number of such jumps after which the next ones lead ahead, and the part of the load by which the
/// first of them does.
const RETURNS: (i32, f64) = (3, 1e-9);
/// Length from which the motion at a bifurcation is a jump.
pub(crate) const LEAP: f64 = 0.03;

/// A path up to its last point.
pub(crate) struct Follower<'a> {
    pub branch: Branch<'a>,
    pub last: Waypoint,
    /// The increment that ends in `last`; `None` at the beginning of a branch.
    pub arc: Option<PathArc>,
    /// Ratio of lengths by the rates at the two ends of the arc.
    stretch: f64,
    /// Length of the next increment.
    length: f64,
    /// Distance of an unstable point ahead, and the resolution of the end of the branch between.
    unstable: Option<(f64, f64)>,
    /// Number of increments tried.
    tried: usize,
    /// Number of jumps since the last load step.
    pub jumps: usize,
    /// The highest load parameter of a jump, and how many jumps have led no further since.
    jumped: (f64, i32),
}

impl<'a> Follower<'a> {
    /// The beginning of the path, an equilibrium at the load parameter 0; `None` if its energy is
    /// not finite. A start that is not stable is left.
    pub(crate) fn new(
        solver: &'a EquilibriumSolver,
        sheet: HingedSheet<'a>,
        stage: PathStage,
        start: Configuration,
    ) -> Option<Self> {
        let mut branch = Branch::new(solver, sheet, stage);
        let state = branch.state(0.0, start, Order::Tangent)?;
        let position = state.position();
        let stable = branch.factorised(&state).factor.filter(HeldFactor::is_stable);
        let mut follower = Self {
            branch,
            last: Waypoint::still(position.clone()),
            arc: None,
            stretch: 1.0,
            length: FIRST,
            unstable: None,
            tried: 0,
            jumps: 0,
            jumped: (f64::NEG_INFINITY, 0),
        };
        let begin = match stable {
            Some(factor) => Some(follower.branch.exact(state, factor)),
            None => follower.branch.settled(&position, solver.settings.max_iterations).ok(),
        };
        if let Some(begin) = begin {
            let moved = follower.branch.distance(&begin.state, &position);
            follower.jumps = usize::from(moved > LEAP);
            follower.restart(begin);
        }
        Some(follower)
    }

    /// The predicted position at a length ahead.
    fn ahead(&self, length: f64) -> PathPoint {
        let mut position = match &self.arc {
            Some(arc) => arc.position(arc.length + length * self.stretch),
            None => PathPoint::sum([(1.0, &self.last.position), (length, &self.last.rate)]),
        };
        if self.at_ahead(length) >= 1.0 {
            position.at = 1.0;
        }
        self.branch.hold(&mut position, &self.last.position);
        position
    }

    fn at_ahead(&self, length: f64) -> f64 {
        match &self.arc {
            Some(arc) => arc.at(arc.length + length * self.stretch),
            None => self.last.position.at + length * self.last.rate.at,
        }
    }

    /// One increment, or a jump from the end of the branch to another; the failure where the path
    /// ends.
    pub(crate) fn advance(&mut self) -> Result<(), Failure> {
        match self.increment() {
            Some(()) => Ok(()),
            None => self.skip_ahead(),
        }
    }

    fn increment(&mut self) -> Option<()> {
        loop {
            self.tried += 1;
            if self.is_exhausted() {
                return None;
            }
            let mut length = self.length.min(TURN / self.last.turning);
            if let Some((distance, resolution)) = self.unstable {
                length = length.min(if distance > resolution { 0.5 } else { 1.0 } * distance);
            }
            // The last increment ends at full load.
            let full = self.at_ahead(1.2 * length) >= 1.0;
            if full {
                length = bisected(0.0, 1.2 * length, |length| self.at_ahead(length) < 1.0);
            }
            let order = if self.arc.is_some() { 4.0 } else { 2.0 };
            let ratio = |error: f64| 0.8 * (AGREEMENT[0] / error).powf(1.0 / order);
            let limit = AGREEMENT[1] * length.max(1.0);
            let start = self.ahead(length);
            let normal = (!full && !self.last.is_still()).then_some(&self.last.rate);
            let found = self.branch.close(start, normal, limit);
            let mut corrected = match found {
                Ok(corrected) => corrected,
                Err(_) if length <= SHORT && self.step_over(length, limit).is_some() => {
                    return Some(());
                }
                Err(error) => {
                    // The ratio of an infinite error is zero.
                    let least = if error.is_finite() { CUT[0] } else { DIVERGED_CUT };
                    self.reject(length, ratio(error).clamp(least, CUT[1]))?;
                    continue;
                }
            };
            let error = corrected.error;
            let stable = self.branch.is_stable(&mut corrected);
            let point = self.branch.point(corrected, Some(&self.last.rate));
            let fold = point.rate.at <= 0.0;
            // The load between stable states falls only past limit points between them, or, by
            // less, by rounding.
            let fallen = self.last.position.at - point.position.at > NOWHERE;
            let passed = stable && !fold && fallen && length > RESOLVED[0];
            if !stable || passed {
                if self.step_over(length, limit).is_some() {
                    return Some(());
                }
                let resolution = RESOLVED[usize::from(!fold && !passed)];
                if length <= resolution {
                    return self.jump(point, fold);
                }
                self.unstable = Some((length, resolution));
                self.branch.effort.rejected += 1;
                continue;
            }
            let next = length * ratio(error).clamp(GROWTH[0], GROWTH[1]);
            let (arc, stretch) = self.arc_to(&point);
            let doubt = self.branch.midpoint_error(&arc, &point);
            if doubt > DOUBT {
                self.reject(length, 0.5)?;
                continue;
            }
            self.accept(point, (arc, stretch), next);
            return Some(());
        }
    }

    /// Accepts the stable equilibrium that is reached downhill from the prediction at a length ahead
    /// if it agrees with that: a branch between, which ends in a jump as short, is left out.
    fn step_over(&mut self, length: f64, limit: f64) -> Option<()> {
        let start = self.ahead(length);
        let grows = start.at > self.last.position.at;
        let landed = grows.then(|| self.branch.settled(&start, SHORT_DESCENT).ok()).flatten()?;
        if self.branch.distance(&landed.state, &start) > limit {
            return None;
        }
        let point = self.branch.point(landed, Some(&self.last.rate));
        let arc = self.arc_to(&point);
        self.accept(point, arc, length);
        Some(())
    }

    fn is_exhausted(&self) -> bool {
        let solver = self.branch.solver;
        self.tried > solver.settings.max_increments || solver.is_stopped()
    }

    /// Restarts from a stable equilibrium at a higher load; the first failure if there is none.
    fn skip_ahead(&mut self) -> Result<(), Failure> {
        let from = self.last.position.clone();
        let mut first = None;
        let partial = SKIPPED.map(|ahead| from.at + ahead);
        for at in partial.into_iter().filter(|at| *at < 1.0).chain([1.0]) {
            if self.is_exhausted() {
                break;
            }
            let mut start = PathPoint { at, ..from.clone() };
            self.branch.hold(&mut start, &from);
            match self.restart_on_stable_branch(start, false) {
                Ok(()) => return Ok(()),
                Err(failure) => _ = first.get_or_insert(failure),
            }
        }
        if self.branch.solver.is_stopped() {
            return Err(Failure::STOPPED);
        }
        Err(first.unwrap_or(Failure::EXHAUSTED))
    }

    fn reject(&mut self, length: f64, factor: f64) -> Option<()> {
        self.branch.effort.rejected += 1;
        self.length = factor * length;
        (self.length > SHORTEST).then_some(())
    }

    /// The arc from the last point to another, and the ratio of lengths by the rates at its two
    /// ends.
    fn arc_to(&self, point: &Waypoint) -> (PathArc, f64) {
        let last = &self.last;
        let product = |position: &PathPoint| {
            (self.branch).product(&last.rate.configuration, &position.configuration)
        };
        let along = |position: &PathPoint| product(position) / product(&last.rate);
        let change = PathPoint::sum([(1.0, &point.position), (-1.0, &last.position)]);
        let (length, stretch) =
            if last.is_still() { (change.at, 1.0) } else { (along(&change), along(&point.rate)) };
        let arc = PathArc {
            from: last.position.clone(),
            from_rate: last.rate.clone(),
            to: point.position.clone(),
            to_rate: PathPoint::sum([(1.0 / stretch, &point.rate)]),
            length,
        };
        (arc, stretch)
    }

    fn accept(&mut self, point: Waypoint, (arc, stretch): (PathArc, f64), next: f64) {
        let left = |(distance, resolution)| ((distance - arc.length) / stretch, resolution);
        self.unstable = self.unstable.map(left).filter(|(distance, _)| *distance > 0.0);
        let before = std::mem::replace(&mut self.last, point);
        if let Some(held) = before.factor {
            self.branch.spare = held.factor.values;
        }
        self.arc = Some(arc);
        (self.stretch, self.length) = (stretch, next);
        self.branch.effort.increments += 1;
    }

    /// The jump that dead loads cause at the end of the branch; `beyond` is the unstable point next
    /// to it.
    fn jump(&mut self, beyond: Waypoint, fold: bool) -> Option<()> {
        let start = if fold { self.beyond_limit_point(&beyond) } else { beyond.position };
        let start = self.step_past_returns(start);
        self.restart_on_stable_branch(start, fold).ok()
    }

    /// Continues the path from the stable equilibrium downhill of a start; a long way to it is a
    /// jump, as is any from a limit point.
    fn restart_on_stable_branch(
        &mut self,
        start: PathPoint,
        limit_point: bool,
    ) -> Result<(), Failure> {
        let iterations = self.branch.solver.settings.max_iterations;
        let landed = self.branch.settled(&start, iterations)?;
        let moved = self.branch.distance(&landed.state, &self.last.position);
        self.jumps += usize::from(limit_point || moved > LEAP);
        self.restart(landed);
        Ok(())
    }

    /// A position at the load of the limit point, past it: there the unstable equilibrium is the
    /// ridge of the energy, from which the sheet moves away. Nearer to the limit point if panels
    /// overlap.
    fn beyond_limit_point(&self, beyond: &Waypoint) -> PathPoint {
        let (arc, _) = self.arc_to(beyond);
        let top = bisected(0.0, arc.length, |length| arc.slope(length) > 0.0);
        let at = arc.at(top).max(self.last.position.at);
        let mut positions = [1.0, 0.3, 0.1, 0.0].map(|part| {
            let mut position = arc.position(top + part * (arc.length - top));
            position.at = at;
            self.branch.hold(&mut position, &self.last.position);
            position
        });
        let finite = |position: &PathPoint| self.branch.state_at(position, Order::Forces).is_some();
        let found = positions.iter().position(finite).unwrap_or(0);
        positions.swap(0, found);
        let [position, ..] = positions;
        position
    }

    /// A start ahead of a jump, the farther the more jumps have ended where they began.
    fn step_past_returns(&mut self, mut start: PathPoint) -> PathPoint {
        let (at, returns) = self.jumped;
        let returns = if start.at - at < NOWHERE { returns + 1 } else { 0 };
        self.jumped = (start.at.max(at), returns);
        let (few, first) = RETURNS;
        if returns > few {
            start.at = (start.at + first * 10f64.powi(returns - few)).min(1.0);
            self.branch.hold(&mut start, &self.last.position);
        }
        start
    }

    /// Continues the path on the branch of a stable equilibrium.
    fn restart(&mut self, landed: Corrected) {
        self.last = self.branch.point(landed, None);
        self.begin();
    }

    /// Begins a branch at the last point.
    pub(crate) fn begin(&mut self) {
        (self.arc, self.stretch) = (None, 1.0);
        (self.length, self.unstable) = (FIRST, None);
    }
}

impl Branch<'_> {
    /// The distance of the path from the middle of an arc, by factors of a tangent near its end.
    fn midpoint_error(&self, arc: &PathArc, point: &Waypoint) -> f64 {
        let middle = arc.position(0.5 * arc.length);
        self.state_at(&middle, Order::Forces).zip(point.factor.as_ref()).map_or(
            f64::INFINITY,
            |(state, factor)| {
                let direct = self.direct(&state, factor);
                let rate = &arc.to_rate.configuration;
                let (motion, _) = self.in_plane(&direct, rate, &arc.to_rate);
                self.length(&state, &motion)
            },
        )
    }

    /// Whether a corrected position is stable. If the tangent near it is not, its own decides.
    fn is_stable(&mut self, corrected: &mut Corrected) -> bool {
        if !corrected.factor.is_stable()
            && let Some(state) = self.state_at(&corrected.position, Order::Tangent)
            && let Some(factor) = self.factorised(&state).factor
        {
            *corrected = Corrected { error: corrected.error, ..self.exact(state, factor) };
        }
        corrected.factor.is_stable()
    }

    /// The stable equilibrium that is reached downhill from a position at constant load.
    pub(crate) fn settled(
        &mut self,
        start: &PathPoint,
        iterations: usize,
    ) -> Result<Corrected, Failure> {
        let Minimum { state, tangent } = self.descended(start, iterations)?;
        match tangent.factor.filter(HeldFactor::is_stable) {
            Some(factor) => Ok(self.exact(state, factor)),
            None => Err(Failure { residual: state.residual, end: DescentEnd::Stagnated }),
        }
    }

    /// An equilibrium with the factors of its own tangent.
    fn exact(&self, state: PotentialState, factor: HeldFactor) -> Corrected {
        Corrected {
            position: state.position(),
            rate: self.rate(&state, &factor),
            state,
            factor,
            error: 0.0,
        }
    }

    /// The stable equilibrium near a predicted position, at its load, or else the minimum that is
    /// reached downhill from it.
    pub(crate) fn stable_near(&mut self, start: &PathPoint) -> Result<Minimum, Failure> {
        match self.balanced(start.clone()).filter(Minimum::is_stable) {
            Some(found) => Ok(found),
            None => self.minimum(start),
        }
    }

    /// The maximum rotation or hinge translation between a position and a state near it, in the
    /// frames of the state.
    pub(crate) fn distance(&self, state: &PotentialState, from: &PathPoint) -> f64 {
        let motion = moved(&state.configuration, &from.configuration, -1.0);
        self.length(state, &motion)
    }
}
