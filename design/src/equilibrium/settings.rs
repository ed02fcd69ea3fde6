//! Settings of the equilibrium solver.

/// The equilibrium solver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolverSettings {
    /// Residual of a converged state, relative to the largest force, unless rounding causes a
    /// larger one.
    pub tolerance: f64,
    /// Every how many steps of a design the path is followed from the flat sheet; the load steps of
    /// the designs between are corrected from the load steps of the design before.
    pub follow_every: usize,
    /// Maximum number of Newton iterations of a descent in energy, as after a jump. A descent ends
    /// before that where it reaches an equilibrium or makes no progress: the longest one known
    /// takes 3000.
    pub max_iterations: usize,
    /// Maximum number of increments that are tried along a path; a path that needs more ends there.
    pub max_increments: usize,
}

/// Residual of an almost converged state, relative to the largest force.
const LOOSE_TOLERANCE: f64 = 1e-6;

impl Default for SolverSettings {
    fn default() -> Self {
        Self { tolerance: 1e-10, follow_every: 30, max_iterations: 10_000, max_increments: 100_000 }
    }
}

impl SolverSettings {
    /// Residual of an almost converged state, relative to the largest force: 1e-6, or a larger
    /// tolerance.
    pub fn loose_tolerance(&self) -> f64 {
        self.tolerance.max(LOOSE_TOLERANCE)
    }
}
