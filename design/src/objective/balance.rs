//! Weights of the path functionals relative to the gradient of the shape.

use crate::equilibrium::displacement_control::dot;
use crate::objective::design_problem::{DesignError, DesignProblem};
use crate::objective::loss::Objective;
use crate::objective::term::Weighted;
use crate::pattern::design_vector::DesignVector;

impl DesignProblem {
    /// Scales the weight of each path functional by the gradient of the Chamfer distance at `start`, so
    /// that at the weight 1 both gradients have the same norm. A functional with zero gradient there keeps
    /// its weight.
    pub fn balanced(mut self, start: &DesignVector) -> Result<Self, DesignError> {
        let mut objective = self.objective;
        self.objective = Objective::from_shape(objective.shape.clone());
        let shape = self.evaluate(start)?.gradient.to_flat();
        let weighted = objective.functionals.iter_mut();
        for functional in weighted.filter(|functional| functional.weight != 0.0) {
            self.objective.functionals = vec![Weighted {
                weight: 1.0,
                ..functional.clone()
            }];
            let both = self.evaluate(start)?.gradient.to_flat();
            let alone: Vec<f64> = std::iter::zip(both, &shape).map(|(b, s)| b - s).collect();
            let alone = norm(&alone);
            if alone > 0.0 {
                functional.weight *= norm(&shape) / alone;
            }
        }
        self.objective = objective;
        Ok(self)
    }
}

fn norm(vector: &[f64]) -> f64 {
    dot(vector, vector).sqrt()
}
