//! What a program that solves windows must do; CalculiX is one, the fake of the tests another.

use crate::calculix::dat::DatError;
use crate::solve::tool_versions::ToolVersions;
use crate::solve::window_solve::WindowSolve;
use hinge::{HingeSample, InvalidMaterial};
use mesher::MeshError;
use std::path::Path;
use std::process::ExitStatus;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use support::file_error::FileError;
use support::program::ToolError;

/// A program that solves windows. Attempts run in parallel.
pub trait WindowSolver: Sync {
    /// The versions that are a part of the identity of its solves.
    fn versions(&self) -> ToolVersions;

    /// Makes one attempt at a solve in the folder `work`, where its inputs, its log and its output remain.
    ///
    /// It is terminated after `limit`, and soon after `stop` becomes true. If the path stops early, at the time limit
    /// or by a signal, its converged increments are returned. An error means that nothing was solved, or that the attempt
    /// was stopped on request.
    fn attempt(
        &self,
        solve: &WindowSolve,
        work: &Path,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<WindowSolution, SolveError>;
}

impl<S: WindowSolver + ?Sized> WindowSolver for &S {
    fn versions(&self) -> ToolVersions {
        (**self).versions()
    }

    fn attempt(
        &self,
        solve: &WindowSolve,
        work: &Path,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<WindowSolution, SolveError> {
        (**self).attempt(solve, work, limit, stop)
    }
}

/// The result of an attempt: samples, and whether they reach the end of the path.
#[derive(Debug, Default)]
pub struct WindowSolution {
    /// One sample per converged increment, in order of lambda; empty if the output is not valid.
    pub samples: Vec<HingeSample>,
    /// Why the samples are not those of a valid complete path; `None` for a complete path.
    pub stopped: Option<SolveError>,
    /// Number of elements of the mesh.
    pub elements: usize,
    /// User and system time of the solver (s), if the operating system reports it.
    pub cpu_seconds: Option<f64>,
    /// Wall time from the mesh to the samples (s).
    pub wall_seconds: f64,
    /// Wall time of the solver (s), a part of `wall_seconds`; zero if it was terminated.
    pub solver_seconds: f64,
    /// Maximum resident memory of the solver (MiB), if the operating system reports it.
    pub peak_memory_mib: Option<f64>,
    /// Newton iterations, including those of cut-back increments.
    pub iterations: usize,
}

/// Why a window solve has no samples, or only samples of a part of the path.
#[derive(Debug, thiserror::Error)]
#[allow(
    missing_docs,
    reason = "the message of each variant is its documentation"
)]
pub enum SolveError {
    #[error(transparent)]
    Material(#[from] InvalidMaterial),
    #[error("the end of the ray contains a number that is not finite: {0:?}")]
    Ray(hinge::HingeDeformation),
    #[error(transparent)]
    Mesh(#[from] MeshError),
    #[error(transparent)]
    Solver(#[from] ToolError),
    #[error(
        "the solver exited with {status} before its first increment\nthe end of its log:\n{tail}"
    )]
    NotStarted { status: ExitStatus, tail: String },
    #[error("the solver diverged at lambda = {lambda}\nthe end of its log:\n{tail}")]
    Diverged { lambda: f64, tail: String },
    #[error("the solver reports success, but its output ends at lambda = {lambda}")]
    Truncated { lambda: f64 },
    #[error(
        "the solver's output and its status file disagree on the increment at lambda = {lambda}"
    )]
    Skipped { lambda: f64 },
    #[error(transparent)]
    Output(#[from] DatError),
    #[error(
        "the energy and the work of the whole ray differ by {residual:.2e} of the energy \
         (limit {MAX_ENERGY_RESIDUAL})"
    )]
    EnergyImbalance { residual: f64 },
    #[error(transparent)]
    File(#[from] FileError),
}

/// Maximum |W - work| / W accepted at the end of a complete path. A partial path is not checked; its samples contain
/// the residual.
pub(crate) const MAX_ENERGY_RESIDUAL: f64 = 0.01;

impl SolveError {
    /// Whether the attempt was stopped on request.
    pub fn is_stop(&self) -> bool {
        matches!(
            self,
            Self::Solver(ToolError::Stopped { .. })
                | Self::Mesh(MeshError::Gmsh(ToolError::Stopped { .. }))
        )
    }
}
