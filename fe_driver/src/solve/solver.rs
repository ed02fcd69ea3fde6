//! What a program that solves must do; CalculiX is one, the fake of the tests another.

use crate::{Solve, SolveError, WindowSolve};
use hinge::HingeSample;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// A program that solves problems of one kind. Attempts run in parallel.
pub trait Solver<S: Solve = WindowSolve>: Sync {
    /// The versions that are a part of the identity of its solves.
    fn versions(&self) -> ToolVersions;

    /// Makes one attempt at a solve in the folder `work`, where its inputs, its log and its output
    /// remain.
    ///
    /// It is terminated after `limit`, and soon after `stop` becomes true. If the path stops early,
    /// at the time limit or by a signal, its converged increments are returned. An error means that
    /// nothing was solved, or that the attempt was stopped on request.
    fn attempt(
        &self,
        solve: &S,
        work: &Path,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<Solution<S::Samples>, SolveError>;
}

impl<S: Solve, T: Solver<S> + ?Sized> Solver<S> for &T {
    fn versions(&self) -> ToolVersions {
        (**self).versions()
    }

    fn attempt(
        &self,
        solve: &S,
        work: &Path,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<Solution<S::Samples>, SolveError> {
        (**self).attempt(solve, work, limit, stop)
    }
}

/// The result of an attempt: samples, and whether they reach the end of the path.
#[derive(Debug, Default)]
pub struct Solution<P = Vec<HingeSample>> {
    /// The converged increments, in order of lambda; empty if the output is not valid.
    pub samples: P,
    /// Why the samples are not the samples of a valid complete path; `None` for a complete path.
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
    /// Newton iterations, including the iterations of cut-back increments.
    pub iterations: usize,
}

/// Versions of the external programs that determine a result.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ToolVersions {
    /// Version of gmsh.
    pub gmsh: String,
    /// Version of CalculiX.
    pub ccx: String,
}

impl std::fmt::Display for ToolVersions {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "gmsh {} and ccx {}", self.gmsh, self.ccx)
    }
}
