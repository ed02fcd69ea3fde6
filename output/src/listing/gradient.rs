//! Objective and gradient in numbers.

use design::{
    objective::{
        design_problem::{DesignError, DesignProblem},
        loss::TermValues,
        scores::outline_error,
    },
    pattern::design_vector::DesignVector,
};
use scene::{Scene, placement::seen};
use serde_json::{Value, json};

/// Lists L of (16), its terms and its gradient in (z, ell, omega) of a design of a scene and its
/// problem.
pub fn gradient(
    scene: &Scene,
    problem: &DesignProblem,
    design: &DesignVector,
) -> Result<Value, DesignError> {
    let found = problem.evaluate(design)?;
    let outline_error = outline_error(&problem.objective, &found.deployment);
    let seen = seen(scene, &found.deployment);
    let weights = problem.objective.weights();
    let weights: TermValues = weights.map(|(name, _, weight)| (name.to_owned(), weight)).collect();
    let gradient = &found.gradient;
    Ok(json!({
        // L of (16) (mm^2), its unweighted terms, and their weights.
        "loss": found.loss,
        "terms": found.terms,
        "weights": weights,
        // dL/dtheta, and the gradient with respect to the constants of the design problem.
        "grad": gradient,
        "sensitivities": found.sensitivities,
        // Maximum componentwise backward error of the adjoint solves.
        "adjoint_residual": found.adjoint_residual,
        // Root mean square distance of the outline from the target (mm).
        "outline_error": outline_error,
        // Area in common of what one sees of the panels and the target, over the area of both.
        "seen": seen,
    }))
}
