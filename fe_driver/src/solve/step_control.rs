//! Automatic increments of a solve.

use hinge::Regime;
use serde::{Deserialize, Serialize};

/// Automatic increments of a static path; lambda runs from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepControl {
    /// First increment; small, because the sheet buckles immediately.
    pub initial: f64,
    /// Minimum increment.
    pub least: f64,
    /// Maximum increment; longer increments overshoot and are cut back.
    pub greatest: f64,
    /// Maximum number of increments.
    pub max_increments: u32,
    /// Maximum residual force, over the average force.
    pub residual: f64,
    /// Maximum displacement correction, over the displacement increment.
    pub correction: f64,
}

impl Default for StepControl {
    fn default() -> Self {
        Self {
            initial: 0.005,
            least: 1e-5,
            greatest: 0.035,
            max_increments: 400,
            residual: 0.02,
            correction: 0.05,
        }
    }
}

impl StepControl {
    /// The usual increments. A plate does not buckle: longer increments change its energy by 0.1 %,
    /// and a path has 22 of them instead of 33.
    pub fn usual(regime: Regime) -> Self {
        match regime {
            Regime::Film => Self::default(),
            Regime::Plate => Self { initial: 0.02, greatest: 0.05, ..Self::default() },
        }
    }

    /// Settings for a ray that stopped early: shorter increments, and more of them.
    pub fn patient() -> Self {
        Self { least: 1e-6, greatest: 0.02, max_increments: 1000, ..Self::default() }
    }
}
