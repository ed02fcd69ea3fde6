//! The potential (10) of a configuration at one point of the path, with its first two derivatives.
//!
//! The load factor zeta is given under load control. Under displacement control the stroke c . q of
//! the loads is prescribed, c being their direction, and zeta is the multiplier with the smallest
//! residual,
//!
//! ```text
//! min |grad U - zeta f|     over zeta; moments are divided by the size of a panel
//! ```
//!
//! The minimised function is then U alone, because the work of the loads is the same in every
//! configuration with that stroke. If there are a weight or loads held constant, U contains their
//! work with negative sign.

use crate::{
    equilibrium::{
        hinged_sheet::HingedSheet,
        load_step::Effort,
        predictor::PathPoint,
        solver::EquilibriumSolver,
        weight::{PanelForce, weights_of_panels},
    },
    hinge_law::{HingeEnergy, Order},
    sheet::kinematics::{Configuration, HingeMotion, Motion, add_at_hinge, add_motions, at_hinge},
};
use hinge::HingeDeformation;
use std::array::from_fn;
use std::iter::zip;
use support::vectors::{self, dot};

/// What grows along a part of the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PathStage {
    /// The weight, without loads, motions of supports or a stroke.
    Weight,
    /// Loads, motions of supports and the stroke, under the whole weight.
    Actuation,
}

/// The potential (10) of a sheet under the loads, stroke and support motions of a solver, and the
/// equilibria on a branch of its path.
pub(crate) struct Branch<'a> {
    pub solver: &'a EquilibriumSolver,
    pub stage: PathStage,
    pub sheet: HingedSheet<'a>,
    /// Lower bound of the force that residuals are relative to (N): if the path passes a state
    /// without forces, the force of the states before.
    pub force: f64,
    /// Size of a panel, by which moments are divided (mm).
    pub panel_size: f64,
    /// Counts what the branch costs.
    pub effort: Effort,
    /// Memory of factors that are not needed any more.
    pub spare: Vec<f64>,
}

/// Maximum number of hinges of a panel, whose rounding errors add up.
const HINGES_OF_A_PANEL: f64 = 4.0;

/// The potential and its first derivatives at a configuration.
pub(crate) struct PotentialState {
    /// The load parameter: the part of the weight that is on; then zeta, unless the stroke of the
    /// loads is prescribed.
    pub at: f64,
    pub configuration: Configuration,
    pub motions: Vec<HingeMotion>,
    pub energies: Vec<HingeEnergy>,
    /// The derivatives that `energies` contain.
    pub order: Order,
    /// zeta
    pub load_factor: f64,
    /// The part of the weight that is on.
    pub weight: f64,
    /// The minimised function: Pi, or U under displacement control, minus the work of the weight
    /// and of the loads held constant.
    pub potential: f64,
    /// Sum of the magnitudes of the terms of `potential`.
    pub magnitude: f64,
    /// Hinge forces predicted by their rates, if they shall replace the actual ones in the part
    /// f . d2(eps) of the tangent.
    pub expected: Option<Vec<[f64; 3]>>,
    /// d Pi / d q over all degrees of freedom: at the supports, the forces that hold them (N, N, N
    /// mm).
    pub unbalanced: Vec<Motion>,
    /// d Pi / d q over the free degrees of freedom.
    pub gradient: Vec<f64>,
    /// Maximum unbalanced force, relative to `force`.
    pub residual: f64,
    /// Maximum unbalanced force caused by the rounding of hinge deformations, relative to `force`.
    pub rounding: f64,
    /// The maximum force (N).
    pub force: f64,
}

impl PotentialState {
    /// Whether the residual is within the tolerance or the rounding error.
    pub(crate) fn is_balanced(&self, tolerance: f64) -> bool {
        self.residual <= tolerance.max(self.rounding)
    }

    /// (F_a, F_s, M_theta) per hinge.
    pub(crate) fn forces(&self) -> Vec<Motion> {
        self.energies.iter().map(|energy| energy.forces).collect()
    }

    /// The state with the stiffness of the hinges in a state near it.
    pub(crate) fn with_stiffness_of(mut self, near: &Self) -> Self {
        for (energy, near) in zip(&mut self.energies, &near.energies) {
            energy.tangent = near.tangent;
        }
        self
    }

    /// The forces of a hinge in the part f . d2(eps) of the tangent.
    fn expected_forces(&self, hinge: usize) -> [f64; 3] {
        let expected = self.expected.as_ref();
        expected.map_or(self.energies[hinge].forces, |expected| expected[hinge])
    }

    pub(crate) fn deformations(&self) -> Vec<HingeDeformation> {
        self.motions.iter().map(HingeMotion::deformation).collect()
    }

    /// The point of the path in this state.
    pub(crate) fn position(&self) -> PathPoint {
        let configuration = self.configuration.clone();
        PathPoint { at: self.at, configuration, forces: self.forces() }
    }
}

impl<'a> Branch<'a> {
    pub(crate) fn new(
        solver: &'a EquilibriumSolver,
        sheet: HingedSheet<'a>,
        stage: PathStage,
    ) -> Self {
        let area: f64 = sheet.sheet.panels.iter().map(|panel| panel.area).sum();
        let mut branch = Self {
            solver,
            stage,
            sheet,
            force: 0.0,
            panel_size: (area / sheet.sheet.panels.len() as f64).sqrt(),
            effort: Effort::default(),
            spare: Vec::new(),
        };
        if solver.drive.is_none() {
            branch.force = branch.largest(solver.loads.iter().copied());
        }
        branch
    }

    /// The state of a position; see [`state`](Self::state).
    pub(crate) fn state_at(&self, position: &PathPoint, order: Order) -> Option<PotentialState> {
        self.state(position.at, position.configuration.clone(), order)
    }

    /// The state with the derivatives of the hinge energies up to `order`, at least the forces;
    /// `None` if the potential is not finite. The tangent needs [`Order::Tangent`].
    pub(crate) fn state(
        &self,
        at: f64,
        configuration: Configuration,
        order: Order,
    ) -> Option<PotentialState> {
        let (sheet, solver) = (self.sheet.sheet, self.solver);
        let motions = HingeMotion::all(sheet, &configuration);
        let deformations: Vec<HingeDeformation> =
            motions.iter().map(HingeMotion::deformation).collect();
        let energies = self.sheet.energies(&deformations, order);

        let mut inner = vec![[0.0; 3]; configuration.len()];
        for ((hinge, motion), energy) in sheet.hinges.iter().zip(&motions).zip(&energies) {
            add_at_hinge(&mut inner, hinge, motion.forces(energy.forces));
        }
        let on_panels = self.on_panels(at, &configuration);
        let mut constant = solver.held.to_vec();
        for (sum, on_panel) in zip(&mut constant, &on_panels) {
            vectors::add(sum, &on_panel.force, 1.0);
        }
        add_motions(&mut inner, &constant, -1.0);
        let (load_factor, worked) = match (&self.solver.drive, self.stage) {
            (Some(_), _) => (self.multiplier(&inner), 0.0),
            (None, PathStage::Weight) => (0.0, 0.0),
            (None, PathStage::Actuation) => (at, at),
        };
        let unbalanced: Vec<Motion> = zip(&inner, &solver.loads)
            .map(|(inner, load)| from_fn(|d| inner[d] - load_factor * load[d]))
            .collect();
        let works = (solver.loads.as_flattened().iter())
            .zip(solver.held.as_flattened())
            .zip(configuration.as_flattened())
            .map(|((load, held), u)| -(worked * load + held) * u);
        let terms = (energies.iter().map(|energy| energy.w))
            .chain(works)
            .chain(on_panels.iter().map(|on_panel| on_panel.potential));
        let gradient = self.solver.pattern.gather(&unbalanced);
        let left = self.largest(solver.pattern.spread(&gradient).into_iter());
        let constant = self.largest(constant.into_iter());
        let loads = constant + load_factor.abs() * self.largest(solver.loads.iter().copied());
        let hinges = self.largest(energies.iter().map(|energy| energy.forces));
        let force = self.force.max(loads).max(hinges);
        // A sheet without any force is balanced.
        let over_force = |unbalanced: f64| match force {
            0.0 => 0.0,
            _ => unbalanced / force,
        };
        let state = PotentialState {
            at,
            weight: self.weight_on(at),
            potential: terms.clone().sum(),
            magnitude: terms.map(f64::abs).sum(),
            residual: over_force(left),
            rounding: over_force(self.rounding(&motions, &energies)),
            force,
            expected: None,
            unbalanced,
            gradient,
            load_factor,
            configuration,
            motions,
            energies,
            order,
        };
        let finite = state.potential.is_finite() && state.gradient.iter().all(|g| g.is_finite());
        finite.then_some(state)
    }

    /// The maximum force on a panel that the rounding of kinematics and hinge law causes (N).
    fn rounding(&self, motions: &[HingeMotion], energies: &[HingeEnergy]) -> f64 {
        let resolution = self.sheet.law.resolution();
        let hinges = self.sheet.sheet.hinges.iter().zip(motions).zip(energies);
        HINGES_OF_A_PANEL
            * self.largest(hinges.map(|((hinge, motion), energy)| {
                let [length, angle] = motion.rounding();
                let length = length + resolution * hinge.w_lig;
                let deformation = [length, length, angle + resolution];
                from_fn(|c| energy.tangent[c][c].abs() * deformation[c])
            }))
    }

    /// The zeta with the smallest residual.
    fn multiplier(&self, inner: &[Motion]) -> f64 {
        let arm = 1.0 / (self.panel_size * self.panel_size);
        let product = |[x, y, m]: Motion, [fx, fy, fm]: Motion| x * fx + y * fy + arm * m * fm;
        let (mut along, mut square) = (0.0, 0.0);
        for (&inner, &load) in zip(inner, &self.solver.loads) {
            along += product(inner, load);
            square += product(load, load);
        }
        along / square
    }

    /// Maximum of forces and moments, as a force (N).
    pub(crate) fn largest(&self, forces: impl Iterator<Item = Motion>) -> f64 {
        forces
            .map(|[x, y, moment]| (x * x + y * y).sqrt().max(moment.abs() / self.panel_size))
            .fold(0.0, f64::max)
    }

    /// H of (20); away from an equilibrium with the predicted hinge forces.
    pub(crate) fn tangent(&self, state: &PotentialState) -> Vec<f64> {
        // A panel belongs to the block of the first of its hinges.
        let mut on_panels = self.on_panels(state.at, &state.configuration);
        let mut take = |panel: usize| on_panels.get_mut(panel).map(std::mem::take);
        let hinges = self.sheet.sheet.hinges.iter().enumerate();
        self.solver.pattern.assemble(hinges.map(|(h, hinge)| {
            let (motion, energy) = (&state.motions[h], &state.energies[h]);
            let mut block = motion.stiffness(&energy.tangent, state.expected_forces(h));
            for (first, panel) in [(0, hinge.panel_a()), (3, hinge.panel_b())] {
                if let Some(on_panel) = take(panel) {
                    for (i, row) in on_panel.stiffness.iter().enumerate() {
                        vectors::add(&mut block[first + i][first..], row, 1.0);
                    }
                }
            }
            block
        }))
    }

    /// The weight of every panel; empty if there is none.
    fn on_panels(&self, at: f64, configuration: &[Motion]) -> Vec<PanelForce> {
        let on = self.weight_on(at);
        match self.solver.weight.map(|component| on * component) {
            [0.0, 0.0] => Vec::new(),
            by_area => weights_of_panels(self.sheet.sheet, by_area, configuration).collect(),
        }
    }

    /// The part of the weight that is on at a load parameter.
    fn weight_on(&self, at: f64) -> f64 {
        match self.stage {
            PathStage::Weight => at,
            PathStage::Actuation => 1.0,
        }
    }

    /// The forces on the panels (F_x, F_y, M) that grow with the load parameter in a state, by
    /// their rates.
    pub(crate) fn driving(&self, state: &PotentialState) -> Vec<Motion> {
        let solver = self.solver;
        match (self.stage, &solver.drive) {
            (PathStage::Weight, _) => {
                weights_of_panels(self.sheet.sheet, solver.weight, &state.configuration)
                    .map(|weight| weight.force)
                    .collect()
            }
            (PathStage::Actuation, None) => solver.loads.to_vec(),
            (PathStage::Actuation, Some(_)) => vec![[0.0; 3]; solver.loads.len()],
        }
    }

    /// The rates of the hinge forces under a motion of all panels.
    pub(crate) fn force_rates(&self, state: &PotentialState, motion: &[Motion]) -> Vec<[f64; 3]> {
        let hinges = state.motions.iter().zip(&state.energies);
        zip(&self.sheet.sheet.hinges, hinges)
            .map(|(hinge, (hinge_motion, energy))| {
                let rates = hinge_motion.rates(at_hinge(hinge, motion));
                energy.tangent.map(|row| dot(&row, &rates))
            })
            .collect()
    }

    /// H times a motion of all panels, including the supported ones.
    pub(crate) fn resistance(&self, state: &PotentialState, motion: &[Motion]) -> Vec<Motion> {
        let mut forces = vec![[0.0; 3]; motion.len()];
        for (h, hinge) in self.sheet.sheet.hinges.iter().enumerate() {
            let (hinge_motion, energy) = (&state.motions[h], &state.energies[h]);
            let (motions, forces_of_hinge) = (at_hinge(hinge, motion), state.expected_forces(h));
            let force = hinge_motion
                .stiffness(&energy.tangent, forces_of_hinge)
                .map(|row| dot(&row, &motions));
            add_at_hinge(&mut forces, hinge, force);
        }
        let on_panels = self.on_panels(state.at, &state.configuration);
        for ((force, on_panel), motion) in zip(&mut forces, on_panels).zip(motion) {
            vectors::add(force, &on_panel.resistance(motion), 1.0);
        }
        forces
    }

    pub(crate) fn moved(
        &self,
        state: &PotentialState,
        motion: &[Motion],
        fraction: f64,
    ) -> Option<PotentialState> {
        self.state(state.at, moved(&state.configuration, motion, fraction), Order::Tangent)
    }

    /// Maximum panel rotation (rad) or hinge translation (panel sizes) of a motion.
    pub(crate) fn length(&self, state: &PotentialState, motion: &[Motion]) -> f64 {
        zip(&self.sheet.sheet.hinges, &state.motions)
            .map(|(hinge, hinge_motion)| {
                let motions = at_hinge(hinge, motion);
                let [along, across, _] = hinge_motion.rates(motions);
                let translation = (along * along + across * across).sqrt() / self.panel_size;
                translation.max(motions[2].abs()).max(motions[5].abs())
            })
            .fold(0.0, f64::max)
    }
}

/// The configuration after a fraction of a motion.
pub(crate) fn moved(configuration: &[Motion], motion: &[Motion], fraction: f64) -> Configuration {
    zip(configuration, motion).map(|(q, d)| from_fn(|c| q[c] + fraction * d[c])).collect()
}
