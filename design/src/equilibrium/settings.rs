//! Settings of the equilibrium solver.

use serde::{Deserialize, Serialize};

/// The method of minimisation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Method {
    /// Newton's method on the sparse tangent.
    #[default]
    Newton,
    /// Limited-memory BFGS as in the paper, with a maximum number of iterations per load increment.
    Lbfgs { max_iterations: usize },
}

/// Tolerances and limits of the solver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolverSettings {
    pub method: Method,
    /// Residual of a converged state, relative to the maximum force, unless rounding causes a larger one.
    pub tolerance: f64,
    /// Residual of an almost converged state.
    pub loose_tolerance: f64,
    /// Maximum number of Newton iterations per load increment.
    pub max_iterations: usize,
    /// Maximum number of halvings of a load step.
    pub max_halvings: u32,
    /// Smallest rotation (rad) that is tested for a jump past a limit point, if the tangents at both ends of its
    /// increment do not explain it.
    pub least_leap: f64,
}

impl Default for SolverSettings {
    fn default() -> Self {
        Self {
            method: Method::default(),
            tolerance: 1e-10,
            loose_tolerance: 1e-6,
            max_iterations: 60,
            max_halvings: 6,
            least_leap: 1e-3,
        }
    }
}

impl SolverSettings {
    pub(crate) fn are_valid(&self) -> bool {
        self.tolerance > 0.0
            && self.tolerance <= self.loose_tolerance
            && self.loose_tolerance < 1.0
            && self.max_iterations >= 1
            && self.max_halvings <= 30
            && self.least_leap > 0.0
    }
}
