//! Settings of the equilibrium solver.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The method of minimisation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Method {
    /// Newton's method on the sparse tangent.
    #[default]
    Newton,
    /// Limited-memory BFGS, as in the paper.
    Lbfgs {
        /// Maximum number of iterations per load increment, 1 to 10 000 000.
        max_iterations: usize,
    },
}

/// Tolerances and limits of the solver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolverSettings {
    /// The method of minimisation; Newton's method by default.
    pub method: Method,
    /// Residual of a converged state, relative to the maximum force, unless rounding causes a larger one;
    /// 1e-10 by default.
    pub tolerance: f64,
    /// Residual of an almost converged state, relative to the maximum force, `tolerance` to 1; 1e-6 by default.
    pub loose_tolerance: f64,
    /// Maximum number of Newton iterations per load increment, at least 1; 60 by default.
    pub max_iterations: usize,
    /// Maximum number of increments of a path, at least 1; 100 000 by default.
    pub max_increments: usize,
}

impl Default for SolverSettings {
    fn default() -> Self {
        Self {
            method: Method::default(),
            tolerance: 1e-10,
            loose_tolerance: 1e-6,
            max_iterations: 60,
            max_increments: 100_000,
        }
    }
}

impl SolverSettings {
    pub(crate) fn are_valid(&self) -> bool {
        self.tolerance > 0.0
            && self.tolerance <= self.loose_tolerance
            && self.loose_tolerance < 1.0
            && self.max_iterations >= 1
            && self.max_increments >= 1
    }
}
