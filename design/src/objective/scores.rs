//! The objective of one design and its terms, as stored for each step and reported.

use crate::{
    equilibrium::load_step::LoadStep,
    geometry::chamfer::chamfer,
    objective::{
        design_problem::{Deployment, Evaluation},
        loss::{Objective, TermValues},
    },
};
use serde::{Deserialize, Serialize};

/// The objective of one design.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Scores {
    /// L of (16) (mm^2).
    pub loss: f64,
    /// Root mean square distance of the deployed outline to the target (mm).
    pub outline_error: f64,
    /// The terms of the loss, unweighted; a penalty without weight is 0.
    #[serde(flatten)]
    pub terms: TermValues,
    /// Fraction of the hinge states of the path inside the training domain of the hinge law.
    pub share_inside: f64,
}

impl Scores {
    /// The scores of an evaluated design.
    pub fn new(objective: &Objective, evaluation: &Evaluation) -> Self {
        Self {
            loss: evaluation.loss,
            outline_error: outline_error(objective, &evaluation.deployment),
            terms: evaluation.terms.clone(),
            share_inside: evaluation.deployment.share_inside(),
        }
    }
}

/// Root mean square distance of the deployed outline points P from the curve through the target's
/// samples (mm).
///
/// It is the square root of the first sum of the Chamfer distance to the curve. The second sum,
/// coverage, also depends on the spacing of the points P, and stays large for a coarse sheet that
/// matches its target.
pub fn outline_error(objective: &Objective, deployment: &Deployment) -> f64 {
    outline_error_at(objective, deployment, deployment.final_step())
}

/// The same for a state of the sheet.
pub fn outline_error_at(objective: &Objective, deployment: &Deployment, step: &LoadStep) -> f64 {
    let shape = &objective.shape;
    let points = deployment.sheet.free_outline_corners();
    let outline = shape.placed(&deployment.outline_at(step, &points));
    let (squared, _) = chamfer(&outline, &shape.target, 0.0);
    squared.sqrt()
}

/// A term as text: four digits after the point, or scientific notation if these do not show it.
pub fn shown(value: f64) -> String {
    if value != 0.0 && value.abs() < 1e-3 { format!("{value:.2e}") } else { format!("{value:.4}") }
}
