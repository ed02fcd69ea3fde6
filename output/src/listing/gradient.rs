//! Objective and gradient in numbers.

use crate::listing::Listing;
use design::geometry::symmetric_difference::intersection_over_union;
use design::objective::design_problem::{DesignError, DesignProblem};
use design::objective::loss::TermValues;
use design::objective::scores::outline_error;
use design::pattern::design_vector::DesignVector;
use scene::Scene;
use scene::placement::deployed_outline;
use serde_json::json;
use support::table::Table;

/// Lists L of (16), its terms and its gradient in (z, ell, omega) of a design of a scene and its
/// problem.
pub fn gradient(
    scene: &Scene,
    problem: &DesignProblem,
    design: &DesignVector,
) -> Result<Listing, DesignError> {
    let found = problem.evaluate(design)?;
    let outline_error = outline_error(&problem.objective, &found.deployment);
    let outline = deployed_outline(scene, &found.deployment);
    let common = intersection_over_union(&outline, &scene.target.points);
    let weights = problem.objective.weights();
    let weights: TermValues = weights.map(|(name, _, weight)| (name.to_owned(), weight)).collect();
    let gradient = &found.gradient;
    let numbers = json!({
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
        // Of the areas inside the deployed outline and inside the target.
        "intersection_over_union": common,
    });
    let number = |value: f64| format!("{value:.6e}");
    let mut table = Table::new(["", "value", "weight"]);
    let rows = std::iter::zip(found.terms.values(), weights.values());
    for (label, (value, weight)) in std::iter::zip(problem.objective.labels(), rows) {
        table.row([label, number(*value), number(*weight)]);
    }
    let norm = |block: &[f64]| block.iter().map(|g| g * g).sum::<f64>().sqrt();
    for (name, value) in [
        ("loss (mm^2)", found.loss),
        ("|dL/dz|", norm(&gradient.pattern.z)),
        ("|dL/dell|", norm(&gradient.pattern.ell.concat())),
        ("|dL/domega|", norm(&gradient.omega)),
        ("adjoint residual", found.adjoint_residual),
        ("outline error (mm)", outline_error),
        ("intersection over union", common),
    ] {
        table.row([name.to_owned(), number(value), String::new()]);
    }
    Ok(Listing { numbers, document: table.into() })
}
