//! The equilibrium path in numbers.

use design::{
    equilibrium::{hinged_sheet::HingedSheet, load_step::LoadStep, solver::EquilibriumSolver},
    hinge_law::{HingeEnergy, Order},
    objective::design_problem::{Deployment, DesignError, DesignProblem},
    pattern::design_vector::DesignVector,
    sheet::{kinematics::deployed_corners, validity::overlap},
};
use serde_json::{Value, json};

/// Follows the equilibrium path of a design and lists its load steps in their order; an error if
/// the model has no equilibrium.
pub fn equilibrium(problem: &DesignProblem, design: &DesignVector) -> Result<Value, DesignError> {
    let mechanics = problem.model.equilibrium()?;
    let Deployment { sheet, path, .. } = problem.deploy(design)?;
    let law = mechanics.law.prepare(&sheet.designs());
    let hinged = mechanics.hinged(&sheet, &*law, false);
    let steps = path.iter().map(|step| list(hinged, step, &mechanics.solver));
    Ok(json!({ "steps": steps.collect::<Vec<_>>() }))
}

/// A load step in numbers.
fn list(hinged: HingedSheet, step: &LoadStep, solver: &EquilibriumSolver) -> Value {
    let condition = Some(step.condition(solver)).filter(|condition| condition.is_finite());
    let deformations: Vec<[f64; 3]> = step.deformations.iter().map(|eps| eps.to_array()).collect();
    let of_law = hinged.law.energies(&step.deformations, Order::Forces);
    let all = hinged.energies(&step.deformations, Order::Forces);
    let sum = |energies: &[HingeEnergy]| energies.iter().map(|energy| energy.w).sum::<f64>();
    let (stored, total) = (sum(&of_law), sum(&all));
    let spring = |c: usize| -> f64 {
        let hinges = std::iter::zip(&of_law, &deformations);
        hinges.map(|(energy, eps)| 0.5 * energy.forces[c] * eps[c]).sum()
    };
    json!({
        // zeta, and the part of the weight of a hanging sheet that is on; 1 once the loads act.
        "load_factor": step.load_factor,
        "weight": step.weight,
        "status": step.status,
        // Maximum unbalanced force, relative to the maximum force, and the part of it that rounding
        // can cause.
        "residual": step.residual,
        "rounding": step.rounding,
        // Newton iterations over all increments; factorisations, and increments accepted and
        // rejected since the step before.
        "iterations": step.effort.iterations,
        "effort": step.effort,
        // Pivots of the tangent that are not positive; 0 in a state that is stable under dead
        // loads.
        "negative_pivots": step.negative_pivots,
        // Of the tangent scaled to a unit diagonal; null if it could not be factorised.
        "condition": condition,
        // Pi of (10) (N mm).
        "Pi": step.potential,
        // U of (10), its parts, and the energies of the springs k_a, k_s and k_theta of (11), null
        // for other laws (N mm).
        "energy": {
            "total": total,
            "law": stored,
            "contact": total - stored,
            "springs": hinged.law.has_constants().then(|| [0, 1, 2].map(spring)),
        },
        // Motion (u_x, u_y, phi) and deployed corners SW, SE, NE, NW of every panel (mm, rad).
        "q": step.configuration,
        "panel_corners": deployed_corners(hinged.sheet, &step.configuration),
        // (a, s, theta) (mm, mm, rad), (F_a, F_s, M_theta) (N, N, N mm) and energy (N mm) of every
        // hinge, with contact.
        "hinge_deformation": deformations,
        "hinge_force": all.iter().map(|energy| energy.forces).collect::<Vec<_>>(),
        "hinge_energy": all.iter().map(|energy| energy.w).collect::<Vec<_>>(),
        // D of every hinge; empty if the hinge law predicts no damage.
        "hinge_damage": step.damage.iter().map(|damage| damage.d).collect::<Vec<_>>(),
        // Whether each hinge is inside the training domain of the hinge law.
        "inside": step.inside,
        // Maximum overlap of two panels, relative to the mean panel area.
        "overlap": overlap(hinged.sheet, &step.configuration),
    })
}
