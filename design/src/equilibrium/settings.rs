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

/// The equilibrium solver.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SolverSettings {
    /// Residual of a converged state, relative to the largest force, 1e-14 to 0.1, unless rounding causes a larger one.
    pub tolerance: f64,
    /// `"newton"`, or `{ lbfgs = { max_iterations = 20000 } }` as in the paper.
    pub method: Method,
    /// Residual of an almost converged state, relative to the largest force, 1e-14 to 0.5; at least `tolerance`.
    pub loose_tolerance: f64,
    /// Maximum number of Newton iterations of a descent in energy, as after a jump, 1 to 1 000 000. A descent ends before
    /// that where it reaches an equilibrium or makes no progress.
    pub max_iterations: usize,
    /// Maximum number of increments that are tried along a path, 1 to 10 000 000; a path that needs more ends there.
    pub max_increments: usize,
    /// Every how many steps of a design the path is followed from the flat sheet, 1 to 10 000; the load steps of the
    /// designs between are corrected from those of the last followed path.
    pub follow_every: usize,
}

impl Default for SolverSettings {
    fn default() -> Self {
        Self {
            tolerance: 1e-10,
            method: Method::default(),
            loose_tolerance: 1e-6,
            max_iterations: 10_000,
            max_increments: 100_000,
            follow_every: 10,
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
            && self.follow_every >= 1
    }
}
