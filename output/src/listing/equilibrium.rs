//! The equilibrium path in numbers.

use design::equilibrium::hinged_sheet::HingedSheet;
use design::equilibrium::load_step::{Effort, LoadStep, Status};
use design::equilibrium::solver::EquilibriumSolver;
use design::hinge_law::{HingeEnergy, Order};
use design::objective::design_problem::{Deployment, DesignError, DesignProblem};
use design::pattern::design_vector::DesignVector;
use design::sheet::kinematics::{Configuration, deployed_corners};
use design::sheet::validity::overlap;
use serde::Serialize;
use std::fmt;

/// All load steps of a design.
#[derive(Clone, Debug, Serialize)]
pub struct EquilibriumListing {
    /// The load steps, in order of the path.
    pub steps: Vec<StepListing>,
}

/// One load step.
#[derive(Clone, Debug, Serialize)]
pub struct StepListing {
    /// zeta.
    pub load_factor: f64,
    /// The part of the weight of a hanging sheet that is on; 1 once the loads act.
    pub weight: f64,
    /// How the step ended.
    pub status: Status,
    /// Maximum unbalanced force, relative to the maximum force.
    pub residual: f64,
    /// The part of the residual that rounding can cause.
    pub rounding: f64,
    /// Newton iterations, summed over all increments.
    pub iterations: usize,
    /// Factorisations of the tangent, and increments accepted and rejected since the step before.
    pub effort: Effort,
    /// Number of pivots of the tangent that are not positive; 0 in a state that is stable under dead loads.
    pub negative_pivots: usize,
    /// Estimated condition number of the tangent scaled to a unit diagonal; `None` if it could not be factorised.
    pub condition: Option<f64>,
    /// Pi of (10) (N mm).
    #[serde(rename = "Pi")]
    pub potential: f64,
    /// The stored energy and its parts.
    pub energy: EnergyParts,
    /// Motion (u_x, u_y, phi) of every panel (mm, mm, rad).
    pub q: Configuration,
    /// Deployed corners SW, SE, NE, NW of every panel (mm).
    pub panel_corners: Vec<[[f64; 2]; 4]>,
    /// (a, s, theta) of every hinge (mm, mm, rad).
    pub hinge_deformation: Vec<[f64; 3]>,
    /// (F_a, F_s, M_theta) of every hinge (N, N, N mm), sum of hinge law and contact.
    pub hinge_force: Vec<[f64; 3]>,
    /// Energy of every hinge (N mm), sum of hinge law and contact.
    pub hinge_energy: Vec<f64>,
    /// D of every hinge; empty if the hinge law predicts no damage.
    pub hinge_damage: Vec<f64>,
    /// Whether each hinge is inside the training domain of the hinge law.
    pub inside: Vec<bool>,
    /// Maximum overlap of two panels, relative to the mean panel area.
    pub overlap: f64,
}

/// The parts of the stored energy.
#[derive(Clone, Debug, Serialize)]
pub struct EnergyParts {
    /// U of (10), including contact (N mm).
    pub total: f64,
    /// Energy of the hinge law (N mm).
    pub law: f64,
    /// Energy of contact (N mm).
    pub contact: f64,
    /// Energies of the springs k_a, k_s and k_theta of (11) (N mm); `None` for other laws.
    pub springs: Option<[f64; 3]>,
}

impl EquilibriumListing {
    /// Follows the equilibrium path of a design; an error if the model has no equilibrium.
    pub fn new(problem: &DesignProblem, design: &DesignVector) -> Result<Self, DesignError> {
        let mechanics = problem.model.mechanics().ok_or(DesignError::NoMechanics)?;
        let Deployment { sheet, path, .. } = problem.deploy(design)?;
        let law = mechanics.law.prepare(&sheet.designs());
        let hinged = mechanics.hinged(&sheet, &*law, false);
        let list = |step: &LoadStep| StepListing::new(hinged, step, &mechanics.solver);
        Ok(Self {
            steps: path.iter().map(list).collect(),
        })
    }
}

impl StepListing {
    fn new(hinged: HingedSheet, step: &LoadStep, solver: &EquilibriumSolver) -> Self {
        let condition = step.condition(solver);
        let hinge_deformation: Vec<[f64; 3]> =
            step.deformations.iter().map(|eps| eps.to_array()).collect();
        let of_law = hinged.law.energies(&step.deformations, Order::Forces);
        let all = hinged.energies(&step.deformations, Order::Forces);
        let (stored, total) = (
            sum(&of_law, |energy| energy.w),
            sum(&all, |energy| energy.w),
        );
        let spring = |c: usize| -> f64 {
            let hinges = std::iter::zip(&of_law, &hinge_deformation);
            hinges
                .map(|(energy, eps)| 0.5 * energy.forces[c] * eps[c])
                .sum()
        };
        Self {
            load_factor: step.load_factor,
            weight: step.weight,
            status: step.status,
            residual: step.residual,
            rounding: step.rounding,
            iterations: step.effort.iterations,
            effort: step.effort,
            negative_pivots: step.negative_pivots,
            condition: condition.is_finite().then_some(condition),
            potential: step.potential,
            energy: EnergyParts {
                total,
                law: stored,
                contact: total - stored,
                springs: hinged.law.has_constants().then(|| [0, 1, 2].map(spring)),
            },
            q: step.configuration.clone(),
            panel_corners: deployed_corners(hinged.sheet, &step.configuration),
            hinge_deformation,
            hinge_force: all.iter().map(|energy| energy.forces).collect(),
            hinge_energy: all.iter().map(|energy| energy.w).collect(),
            hinge_damage: step.damage.iter().map(|damage| damage.d).collect(),
            inside: step.inside.clone(),
            overlap: overlap(hinged.sheet, &step.configuration),
        }
    }
}

fn sum(energies: &[HingeEnergy], part: impl Fn(&HingeEnergy) -> f64) -> f64 {
    energies.iter().map(part).sum()
}

impl fmt::Display for EquilibriumListing {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(
            f,
            "    zeta  weight  status       residual  its  fac  rej  neg  condition     U (N mm)    Pi (N mm)  opening (deg)"
        )?;
        for step in &self.steps {
            let openings = step.hinge_deformation.iter().map(|eps| eps[2].abs());
            let open_deg = openings.fold(0.0, f64::max).to_degrees();
            let condition = step.condition.unwrap_or(f64::INFINITY);
            writeln!(
                f,
                "{:>8.4}  {:>6.2}  {:<11} {:>9.1e} {:>4} {:>4} {:>4} {:>4}  {condition:>9.1e} {:>12.5e} {:>12.5e} {open_deg:>14.2}",
                step.load_factor,
                step.weight,
                format!("{:?}", step.status),
                step.residual,
                step.effort.iterations,
                step.effort.factorisations,
                step.effort.rejected,
                step.negative_pivots,
                step.energy.total,
                step.potential,
            )?;
        }
        Ok(())
    }
}
