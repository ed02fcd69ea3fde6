//! Load steps of an equilibrium path, from the flat sheet or from the end of another path.
//!
//! Newton's method follows the path in increments of its own, and the load steps are read off it:
//! the cubic between two points of the path is the start of a correction at the load of the step.

use crate::{
    equilibrium::{
        continuation::{Follower, LEAP},
        corrector::Waypoint,
        displacement_control::work,
        hinged_sheet::HingedSheet,
        load_step::{DescentEnd, LoadStep, Status, StepTangent},
        newton::{Failure, Minimum},
        potential::{Branch, PathStage, PotentialState},
        predictor::PathPoint,
        solver::EquilibriumSolver,
        weight::weights_of_panels,
    },
    hinge_law::Order,
    sheet::kinematics::{Configuration, HingeMotion, Motion, add_at_hinge},
};
use support::vectors;

impl EquilibriumSolver {
    /// Follows the equilibrium path from the flat sheet: first the load steps of the weight, then
    /// the load steps of the loads. The path ends early if no equilibrium is found.
    ///
    /// # Panics
    /// If the grids of sheet and solver differ.
    pub fn path(&self, sheet: HingedSheet) -> Vec<LoadStep> {
        let mut path = self.weighed(sheet);
        let start = match path.last() {
            Some(last) if last.status == Status::Diverged => return path,
            Some(last) => last.configuration.clone(),
            None => self.flat(),
        };
        path.extend(self.path_from(sheet, start));
        path
    }

    /// The load steps of the weight; none without weight.
    fn weighed(&self, sheet: HingedSheet) -> Vec<LoadStep> {
        if self.weight_steps() == 0 {
            return Vec::new();
        }
        let start = self.start(sheet.sheet).unwrap_or_else(|| self.flat());
        self.read(sheet, PathStage::Weight, start, self.ends(PathStage::Weight))
    }

    /// Follows the equilibrium path from a start that is an equilibrium under the weight and the
    /// forces held constant.
    ///
    /// # Panics
    /// If the sheet or the start has another grid than the solver.
    pub(crate) fn path_from(&self, sheet: HingedSheet, start: Configuration) -> Vec<LoadStep> {
        self.read(sheet, PathStage::Actuation, start, self.ends(PathStage::Actuation))
    }

    /// The load parameters of the load steps, from the sheet before the loads to full load.
    pub fn load_parameters(&self) -> impl Iterator<Item = f64> + use<> {
        self.ends(PathStage::Actuation)
    }

    /// The load parameters of the load steps of a part of the path.
    pub(crate) fn ends(&self, stage: PathStage) -> impl Iterator<Item = f64> + use<> {
        let steps = match stage {
            PathStage::Weight => self.weight_steps(),
            PathStage::Actuation => self.steps,
        };
        (1..=steps).map(move |i| i as f64 / steps as f64)
    }

    /// The equilibria at load parameters, in ascending order, on the path from the sheet before the
    /// loads: fractions of the loads or, if they are prescribed, of the stroke and the support
    /// motions.
    ///
    /// # Panics
    /// If the grids of sheet and solver differ.
    pub fn load_steps_at(&self, sheet: HingedSheet, parameters: &[f64]) -> Vec<LoadStep> {
        let weighed = self.weighed(sheet).pop();
        let start = weighed.map_or_else(|| self.flat(), |last| last.configuration);
        self.read(sheet, PathStage::Actuation, start, parameters.iter().copied())
    }

    /// The load step at full load in a configuration that is in equilibrium there, as one of a path
    /// is.
    ///
    /// # Panics
    /// If the grids of sheet and solver differ.
    pub fn full_load(&self, sheet: HingedSheet, configuration: Configuration) -> LoadStep {
        let mut branch = Branch::new(self, sheet, PathStage::Actuation);
        let Some(state) = branch.state(1.0, configuration.clone(), Order::Design) else {
            return not_finite(sheet, configuration);
        };
        let found = state.residual <= self.settings.loose_tolerance().max(state.rounding);
        let tangent = branch.factorised(&state);
        let step = branch.load_step(Minimum { state, tangent }, 0);
        if found {
            return step;
        }
        LoadStep { status: Status::Diverged, ..step }
    }

    /// The forces (F_x, F_y, M) on every panel that hold the sheet in a configuration with a part
    /// of its weight: the loads on free degrees of freedom, the reactions at supported ones (N, N,
    /// N mm).
    pub fn holding_forces(
        &self,
        hinged: HingedSheet,
        weight: f64,
        configuration: &[Motion],
    ) -> Vec<Motion> {
        let sheet = hinged.sheet;
        let motions = HingeMotion::all(sheet, configuration);
        let deformations: Vec<_> = motions.iter().map(HingeMotion::deformation).collect();
        let energies = hinged.energies(&deformations, Order::Forces);
        let mut forces = vec![[0.0; 3]; sheet.panels.len()];
        for ((hinge, motion), energy) in sheet.hinges.iter().zip(&motions).zip(energies) {
            add_at_hinge(&mut forces, hinge, motion.forces(energy.forces));
        }
        let by_area = self.weight.map(|component| weight * component);
        let weights = weights_of_panels(sheet, by_area, configuration);
        for (force, weight) in std::iter::zip(&mut forces, weights) {
            vectors::add(force, &weight.force, -1.0);
        }
        forces
    }

    /// The forces (F_x, F_y, M) by which the supports hold the panels in an equilibrium at full
    /// load (N, N, N mm); zero at free degrees of freedom.
    pub fn reactions(&self, sheet: HingedSheet, configuration: &[Motion]) -> Vec<Motion> {
        let branch = Branch::new(self, sheet, PathStage::Actuation);
        let state = branch.state(1.0, configuration.to_vec(), Order::Forces);
        let state = state.expect("the energy of an equilibrium is finite");
        self.at_supports(&state.unbalanced)
    }

    /// The load steps that end at load parameters in ascending order. The path ends early if no
    /// equilibrium is found.
    fn read(
        &self,
        sheet: HingedSheet,
        stage: PathStage,
        start: Configuration,
        ends: impl Iterator<Item = f64>,
    ) -> Vec<LoadStep> {
        let Some(mut follower) = self.follower(sheet, stage, start.clone()) else {
            return vec![not_finite(sheet, start)];
        };
        let mut path: Vec<LoadStep> = Vec::with_capacity(self.steps);
        for end in ends {
            let mut step = follower.load_step(end);
            if self.is_stopped() {
                step.status = Status::Diverged;
                step.descent_end = Some(DescentEnd::Stopped);
            }
            let diverged = step.status == Status::Diverged;
            path.push(step);
            if diverged {
                break;
            }
        }
        path
    }

    /// The beginning of the path from a start; `None` if the energy there is not finite.
    fn follower<'a>(
        &'a self,
        sheet: HingedSheet<'a>,
        stage: PathStage,
        start: Configuration,
    ) -> Option<Follower<'a>> {
        assert_eq!(
            self.topology, sheet.sheet.topology,
            "the topologies of solver and sheet must be the same"
        );
        assert_eq!(start.len(), self.topology.panel_count(), "one motion per panel");
        Follower::new(self, sheet, stage, start)
    }
}

/// The end of a path in a configuration whose energy is not finite.
fn not_finite(sheet: HingedSheet, configuration: Configuration) -> LoadStep {
    LoadStep {
        load_factor: 0.0,
        status: Status::Diverged,
        residual: f64::INFINITY,
        descent_end: Some(DescentEnd::NotFinite),
        ..LoadStep::ideal(sheet.sheet, configuration)
    }
}

impl Follower<'_> {
    fn load_step(&mut self, to: f64) -> LoadStep {
        let found = self.followed(to);
        let jumps = std::mem::take(&mut self.jumps);
        match found {
            Ok(minimum) => self.branch.load_step(minimum, jumps),
            Err(Failure { residual, end }) => {
                LoadStep { residual, descent_end: Some(end), ..self.last_point(jumps) }
            }
        }
    }

    /// The last point that was found, without a tangent: where the path ends.
    fn last_point(&mut self, jumps: usize) -> LoadStep {
        let state = self.branch.state_at(&self.last.position, Order::Tangent);
        let state = state.expect("this state was computed before");
        self.branch.reported(state, None, Status::Diverged, jumps)
    }

    /// The equilibrium at `to` on the path.
    fn followed(&mut self, to: f64) -> Result<Minimum, Failure> {
        while self.last.position.at < to {
            if let Err(failure) = self.advance() {
                // A sheet without stiffness is at rest in any state; beyond the increments the load
                // steps go on.
                let (minimum, moved) = match failure.end {
                    DescentEnd::Stagnated | DescentEnd::Increments => {
                        self.minimised(to).map_err(|_| failure)?
                    }
                    _ => return Err(failure),
                };
                self.jumps += usize::from(moved > LEAP);
                return Ok(minimum);
            }
        }
        let mut position = match &self.arc {
            Some(arc) => arc.at_load(to),
            None => PathPoint { at: to, ..self.last.position.clone() },
        };
        self.branch.hold(&mut position, &self.last.position);
        let minimum = self.branch.stable_near(&position)?;
        let moved = self.branch.distance(&minimum.state, &position);
        // The start without an arc is a position at a higher load.
        self.jumps += usize::from(self.arc.is_some() && moved > LEAP);
        Ok(minimum)
    }

    /// The minimum at `to` that is reached from the last point, from where the path goes on, and
    /// its distance.
    fn minimised(&mut self, to: f64) -> Result<(Minimum, f64), Failure> {
        let mut start = PathPoint { at: to, ..self.last.position.clone() };
        self.branch.hold(&mut start, &self.last.position);
        let minimum = self.branch.minimum(&start)?;
        let moved = self.branch.distance(&minimum.state, &start);
        self.last = Waypoint::still(minimum.state.position());
        self.begin();
        Ok((minimum, moved))
    }
}

impl Branch<'_> {
    /// The load step at a minimum, `jumps` jumps after the last.
    pub(crate) fn load_step(&mut self, minimum: Minimum, jumps: usize) -> LoadStep {
        let status = self.status(&minimum, jumps > 0);
        self.force = minimum.state.force;
        self.reported(minimum.state, Some(minimum.tangent), status, jumps)
    }

    /// The load step in a state, with what it cost since the last.
    fn reported(
        &mut self,
        state: PotentialState,
        tangent: Option<StepTangent>,
        status: Status,
        jumps: usize,
    ) -> LoadStep {
        let effort = std::mem::take(&mut self.effort);
        // The minimised function under a drive does not contain the work of the loads.
        let driven = match self.solver.drive {
            Some(_) => state.load_factor * work(&self.solver.loads, &state.configuration),
            None => 0.0,
        };
        let deformations = state.deformations();
        let factor = tangent.as_ref().and_then(|tangent| tangent.factor.as_ref());
        let factor = factor.map(|held| &held.factor);
        let (law, damage_gradient) = (self.sheet.law, self.sheet.damage_gradient);
        LoadStep {
            load_factor: state.load_factor,
            inside: law.inside(&deformations),
            damage: law.damage(&deformations, damage_gradient),
            deformations,
            energies: state.energies.iter().map(|energy| energy.w).collect(),
            weight: state.weight,
            potential: state.potential - driven,
            status,
            descent_end: None,
            residual: state.residual,
            rounding: state.rounding,
            effort,
            jumps,
            negative_pivots: factor.map_or(0, |factor| factor.negative_pivots),
            pivot_ratio: factor.map_or(0.0, |factor| factor.pivot_ratio),
            configuration: state.configuration,
            tangent,
            hinges: state.energies,
            order: state.order,
        }
    }

    fn status(&self, minimum: &Minimum, jumped: bool) -> Status {
        let settings = &self.solver.settings;
        // Rounding may explain a residual above the loose tolerance; it is no converged state
        // nevertheless.
        let balanced = minimum.state.is_balanced(settings.tolerance)
            && minimum.state.residual <= settings.loose_tolerance();
        let law = self.sheet.law;
        if !balanced || !minimum.is_stable() {
            Status::Almost
        } else if jumped {
            Status::LimitPoint
        } else if law.inside(&minimum.state.deformations()).contains(&false) {
            Status::LeftDomain
        } else {
            Status::Converged
        }
    }
}
