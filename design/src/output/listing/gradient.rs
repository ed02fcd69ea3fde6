//! Objective and gradient in numbers.

use crate::geometry::intersection_over_union::intersection_over_union;
use crate::objective::design_problem::{DesignError, Evaluation, Sensitivities};
use crate::objective::loss::OutlinePoints;
use crate::objective::outline_error::outline_error;
use crate::objective::path_functionals::PerFunctional;
use crate::pattern::design_vector::DesignVector;
use crate::scene::placement::deployed_outline;
use crate::scene::{Scene, SceneError};
use serde::Serialize;
use std::fmt;

/// L of (16), its terms and its gradient in (z, ell, omega).
#[derive(Clone, Debug, Serialize)]
pub struct GradientListing {
    /// L of (16) (mm^2).
    pub loss: f64,
    /// The unweighted terms of L.
    pub terms: TermsListing,
    /// w_j; that of the Chamfer distance is 1.
    pub weights: PerFunctional,
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

/// The unweighted terms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TermsListing {
    /// mm^2
    pub chamfer: f64,
    /// The path functionals (17)-(19).
    #[serde(flatten)]
    pub path: PerFunctional,
}

/// Why there is no gradient.
#[derive(Debug, thiserror::Error)]
#[allow(
    missing_docs,
    reason = "the message of each variant is its documentation"
)]
pub enum GradientListingError {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Design(#[from] DesignError),
}

impl GradientListing {
    /// Evaluates a design of a scene.
    pub fn new(scene: &Scene, design: &DesignVector) -> Result<Self, GradientListingError> {
        let problem = scene.problem()?;
        let evaluation = problem.evaluate(design)?;
        let outline_error = outline_error(&problem.objective, &evaluation.deployment);
        let outline = deployed_outline(scene, &evaluation.deployment, OutlinePoints::All);
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
            terms: TermsListing {
                chamfer: terms.chamfer,
                path: terms.path,
            },
            weights: problem.objective.weights,
            grad: gradient,
            sensitivities,
            adjoint_residual,
            outline_error,
            intersection_over_union: intersection_over_union(&outline, scene.target.points()),
        })
    }
}

impl fmt::Display for GradientListing {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let (terms, weights) = (&self.terms, &self.weights);
        writeln!(f, "{:<24}{:>14}{:>14}", "", "value", "weight")?;
        for (name, value, weight) in [
            ("Chamfer (mm^2)", terms.chamfer, 1.0),
            ("damage", terms.path.damage, weights.damage),
            ("compression", terms.path.compression, weights.compression),
            ("shear", terms.path.shear, weights.shear),
        ] {
            writeln!(f, "{name:<24}{value:>14.6e}{weight:>14.6e}")?;
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
