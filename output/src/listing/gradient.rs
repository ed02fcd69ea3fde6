//! Objective and gradient in numbers.

use design::geometry::symmetric_difference::intersection_over_union;
use design::objective::design_problem::{DesignError, DesignProblem, Evaluation, Sensitivities};
use design::objective::loss::TermValues;
use design::objective::scores::outline_error;
use design::pattern::design_vector::DesignVector;
use design::scene::Scene;
use design::scene::placement::deployed_outline;
use serde::Serialize;
use std::fmt;

/// L of (16), its terms and its gradient in (z, ell, omega).
#[derive(Clone, Debug, Serialize)]
pub struct GradientListing {
    /// L of (16) (mm^2).
    pub loss: f64,
    /// The unweighted terms of L.
    pub terms: TermValues,
    /// Their weights.
    pub weights: TermValues,
    /// The terms in words, with their units.
    #[serde(skip)]
    pub labels: Vec<String>,
    /// dL/dtheta.
    pub grad: DesignVector,
    /// The gradient with respect to the constants of the design problem.
    pub sensitivities: Sensitivities,
    /// Maximum componentwise backward error of the adjoint solves.
    pub adjoint_residual: f64,
    /// Root mean square distance of the outline from the target (mm).
    pub outline_error: f64,
    /// Intersection over union of the areas inside the deployed outline and inside the target.
    pub intersection_over_union: f64,
}

impl GradientListing {
    /// Evaluates a design of a scene and its problem.
    pub fn new(
        scene: &Scene,
        problem: &DesignProblem,
        design: &DesignVector,
    ) -> Result<Self, DesignError> {
        let evaluation = problem.evaluate(design)?;
        let outline_error = outline_error(&problem.objective, &evaluation.deployment);
        let outline = deployed_outline(scene, &evaluation.deployment);
        let Evaluation {
            loss,
            terms,
            gradient,
            sensitivities,
            adjoint_residual,
            ..
        } = evaluation;
        Ok(Self {
            loss,
            terms,
            weights: (problem.objective.weights())
                .map(|(name, _, weight)| (name.to_owned(), weight))
                .collect(),
            labels: problem.objective.labels(),
            grad: gradient,
            sensitivities,
            adjoint_residual,
            outline_error,
            intersection_over_union: intersection_over_union(&outline, &scene.target.points),
        })
    }
}

impl fmt::Display for GradientListing {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "{:<24}{:>14}{:>14}", "", "value", "weight")?;
        let rows = std::iter::zip(self.terms.values(), self.weights.values());
        for (label, (value, weight)) in std::iter::zip(&self.labels, rows) {
            writeln!(f, "{label:<24}{value:>14.6e}{weight:>14.6e}")?;
        }
        let norm = |block: &[f64]| block.iter().map(|g| g * g).sum::<f64>().sqrt();
        let gradient = &self.grad;
        let omega = norm(&gradient.omega);
        for (name, value) in [
            ("loss (mm^2)", self.loss),
            ("|dL/dz|", norm(&gradient.pattern.z)),
            ("|dL/dell|", norm(&gradient.pattern.ell.concat())),
            ("|dL/domega|", omega),
            ("adjoint residual", self.adjoint_residual),
            ("outline error (mm)", self.outline_error),
            ("intersection over union", self.intersection_over_union),
        ] {
            writeln!(f, "{name:<24}{value:>14.6e}")?;
        }
        Ok(())
    }
}
