//! Distance of the deployed outline from the target, as a root mean square length.

use crate::geometry::chamfer::{Chamfer, Precision};
use crate::objective::design_problem::Deployment;
use crate::objective::loss::Objective;

/// Root mean square distance of the deployed outline points P from the curve through the target's
/// samples (mm).
///
/// It is the square root of the first sum of the Chamfer distance to the curve. The second sum, coverage, also
/// depends on the spacing of the points P, and stays large for a coarse sheet that matches its target.
pub fn outline_error(objective: &Objective, deployment: &Deployment) -> f64 {
    let shape = &objective.shape;
    let points = shape.outline.corners(&deployment.sheet);
    let outline = shape.placed(&deployment.outline(&points));
    let precision = Chamfer {
        coverage_weight: 0.0,
        smoothing: 0.0,
        precision: Precision::Curve,
    };
    let (squared, _) = precision.evaluate(&outline, &shape.target);
    squared.sqrt()
}
