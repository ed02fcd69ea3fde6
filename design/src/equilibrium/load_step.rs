//! The state of the sheet at one step of the equilibrium path, and how it was found.

use crate::{
    equilibrium::{
        displacement_control::{HeldFactor, Stroke},
        solver::EquilibriumSolver,
    },
    hinge_law::{HingeDamage, HingeEnergy, Order},
    sheet::{
        cut_sheet::Sheet,
        kinematics::{Configuration, hinge_deformations},
    },
};
use hinge::HingeDeformation;
use serde::Serialize;
use support::{statistics::root_mean_square, vectors::dot};

/// How a load step ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// A stable equilibrium to the tolerance, or to the rounding error of hinges that are stiff
    /// relative to the load, inside the domain of the hinge law.
    Converged,
    /// A stable equilibrium with hinges outside the domain of the hinge law.
    LeftDomain,
    /// The residual stagnated between the two tolerances, or the state is stationary but its
    /// tangent is singular or rounding leaves a residual above the loose tolerance.
    Almost,
    /// A stable equilibrium on another branch than the state before: that branch ended at a limit
    /// point of the load, or of the stroke under displacement control, and the sheet jumped.
    LimitPoint,
    /// No equilibrium was found: this is the last one found before, and the path ends.
    Diverged,
}

/// Why a descent in energy ended without a minimum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, thiserror::Error)]
#[serde(rename_all = "kebab-case")]
pub enum DescentEnd {
    /// The maximum number of iterations was made while the energy still decreased.
    #[error("the energy still decreases at the last iteration")]
    Iterations,
    /// The path has more increments than the maximum, and no equilibrium was found beyond them.
    #[error("the path is longer than the maximum number of increments")]
    Increments,
    /// No further step lowers the energy, but the residual is above the loose tolerance.
    #[error("no step lowers the energy further, but the forces are not balanced")]
    Stagnated,
    /// The energy or its gradient is not a finite number.
    #[error("the energy is not a finite number")]
    NotFinite,
    /// Stopped on request.
    #[error("stopped on request")]
    Stopped,
}

/// What a part of the path cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Effort {
    /// Newton corrections.
    pub iterations: usize,
    /// Factorisations of a tangent.
    pub factorisations: usize,
    /// Increments of the path that were accepted.
    pub increments: usize,
    /// Increments that were repeated with a shorter one.
    pub rejected: usize,
}

/// The state at one load factor.
#[derive(Clone, Debug, derive_more::Display)]
#[display("load factor {load_factor:.4}: {status:?}, {}, {} iterations", residual_in_words(*residual), effort.iterations)]
pub struct LoadStep {
    /// zeta: i/N, or under displacement control the multiplier of the stroke. 0 while the weight
    /// comes on, unless a stroke of zero is prescribed meanwhile.
    pub load_factor: f64,
    /// The part of the weight that is on; 1 once the loads act.
    pub weight: f64,
    /// q: the motion of every panel.
    pub configuration: Configuration,
    /// (8) per hinge.
    pub deformations: Vec<HingeDeformation>,
    /// W + contact per hinge (N mm).
    pub energies: Vec<f64>,
    /// The predicted damage (12) per hinge; empty if the law predicts none.
    pub damage: Vec<HingeDamage>,
    /// Pi of (10) (N mm).
    pub potential: f64,
    /// How the step ended.
    pub status: Status,
    /// Why no equilibrium was found beyond this step, if the path ends early.
    pub descent_end: Option<DescentEnd>,
    /// Maximum unbalanced force, relative to the maximum force.
    pub residual: f64,
    /// The part of the residual that rounding can cause: below it no state is closer to
    /// equilibrium.
    pub rounding: f64,
    /// What the path cost since the step before.
    pub effort: Effort,
    /// Number of jumps since the step before, at limit points or bifurcations.
    pub jumps: usize,
    /// Number of pivots of the tangent that are not positive: 0 in a state that is stable under
    /// dead loads, and where `pivot_ratio` is 0. Under displacement control past a limit point of
    /// the load it is 1.
    pub negative_pivots: usize,
    /// Minimum ratio of a pivot of the tangent to its diagonal entry: small near a singular
    /// tangent, 0 if the tangent could not be factorised.
    pub pivot_ratio: f64,
    /// Whether each hinge is inside the domain of the hinge law.
    pub inside: Vec<bool>,
    /// H at the configuration, with its factors, for the adjoint.
    pub(crate) tangent: Option<StepTangent>,
    /// Energies of the hinges, of law and contact, with their derivatives up to `order`.
    pub(crate) hinges: Vec<HingeEnergy>,
    pub(crate) order: Order,
}

/// H at an equilibrium.
#[derive(Clone, Debug)]
pub(crate) struct StepTangent {
    pub values: Vec<f64>,
    /// `None` if it is singular.
    pub factor: Option<HeldFactor>,
}

/// A relative residual in words; forces beyond the range of numbers have none.
pub(crate) fn residual_in_words(residual: f64) -> String {
    if residual.is_finite() {
        format!("relative residual {residual:.1e}")
    } else {
        "forces that are no finite numbers".into()
    }
}

impl LoadStep {
    /// Root mean square of the rotations of the hinges (rad).
    pub fn opening(&self) -> f64 {
        root_mean_square(self.deformations.iter().map(|state| state.theta))
    }

    /// Mean of the rotations of the hinges (rad).
    pub fn mean_opening(&self) -> f64 {
        let rotations = self.deformations.iter().map(|state| state.theta);
        rotations.sum::<f64>() / self.deformations.len() as f64
    }

    /// Estimate of the condition number of the tangent in the 1-norm, scaled to a unit diagonal so
    /// that it does not depend on units; infinite if the tangent could not be factorised.
    pub fn condition(&self, solver: &EquilibriumSolver) -> f64 {
        match &self.tangent {
            Some(StepTangent { values, factor: Some(held) }) => {
                solver.pattern.condition(values, &held.factor)
            }
            _ => f64::INFINITY,
        }
    }

    /// Stiffness of the sheet against a further load, the supports being held: increment of the sum
    /// of the loads for an increment of their stroke, 1 / (c . H^-1 c) (N/mm; N mm/rad if there are
    /// only couples). Negative past a limit point of the load; `None` without loads, or if the
    /// tangent could not be factorised.
    pub fn stiffness(&self, solver: &EquilibriumSolver) -> Option<f64> {
        let held = self.tangent.as_ref()?.factor.as_ref()?;
        let stroke = Stroke::new(&solver.loads, &solver.pattern.gather(&solver.loads))?;
        let mut response = stroke.direction().to_vec();
        solver.pattern.solve(&held.factor, &mut response);
        let stiffness = 1.0 / dot(stroke.direction(), &response);
        (!held.shifted && stiffness.is_finite()).then_some(stiffness)
    }

    /// The ideal deployment as a path of one step, without energy and without unbalanced forces.
    pub fn ideal(sheet: &Sheet, configuration: Configuration) -> Self {
        let hinges = sheet.hinges.len();
        Self {
            load_factor: 1.0,
            weight: 0.0,
            deformations: hinge_deformations(sheet, &configuration),
            configuration,
            energies: vec![0.0; hinges],
            damage: Vec::new(),
            potential: 0.0,
            status: Status::Converged,
            descent_end: None,
            residual: 0.0,
            rounding: 0.0,
            effort: Effort::default(),
            jumps: 0,
            negative_pivots: 0,
            pivot_ratio: 1.0,
            inside: vec![true; hinges],
            tangent: None,
            hinges: Vec::new(),
            order: Order::Value,
        }
    }
}
