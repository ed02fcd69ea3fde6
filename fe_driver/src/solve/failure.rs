//! Why an attempt failed: the message of the solver on the problem, or what happened on the
//! machine.

use crate::solve::solve_error::SolveError;
use mesher::MeshError;
use serde::{Deserialize, Serialize};
use strum::VariantNames;
use support::program::ToolError;

/// Why a solve has no samples, or only samples of a part of its path. Records and tables use its
/// name.
#[derive(
    Clone,
    Copy,
    Debug,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Serialize,
    Deserialize,
    strum::Display,
    strum::EnumString,
    strum::VariantNames,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
#[strum(parse_err_ty = UnknownFailure, parse_err_fn = UnknownFailure::new)]
pub enum FailureKind {
    /// The design, the material or the path is impossible.
    InvalidInput,
    /// gmsh failed, or its mesh was rejected.
    MeshFailed,
    /// The solver refused its input deck.
    NotStarted,
    /// The increment fell below the allowed minimum.
    Diverged,
    /// Terminated at the time limit.
    TimedOut,
    /// Terminated because it wrote a file that is larger than any result.
    TooMuchOutput,
    /// Energy and work disagree.
    EnergyImbalance,
}

/// What ended an attempt before the end of its path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The problem, as far as its solver says: the next step of the ladder may help.
    Problem(FailureKind),
    /// The machine: the solver was killed, or its output is damaged or missing. The same attempt
    /// may succeed.
    Machine,
    /// What would end every other attempt too: a missing tool, a full disk, a stop request.
    Run,
}

/// An unknown name of a failure kind; the message lists the known ones.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("unknown failure `{0}`; choose one of {known}", known = FailureKind::VARIANTS.join(", "))]
pub struct UnknownFailure(String);

impl UnknownFailure {
    fn new(name: &str) -> Self {
        Self(name.to_owned())
    }
}

/// The message in a program's log when the disk is full.
const DISK_FULL: &str = "No space left on device";
/// The word with which gmsh begins its message on a mesh that it cannot make.
const GMSH_ERROR: &str = "Error";
/// The message of CalculiX when the memory is full.
const MEMORY_FULL: &str = "error allocating memory";

impl Cause {
    /// What an error of an attempt was caused by.
    pub fn of(error: &SolveError) -> Self {
        use FailureKind::{
            Diverged, EnergyImbalance, InvalidInput, MeshFailed, NotStarted, TimedOut,
            TooMuchOutput,
        };
        match error {
            SolveError::Material(_)
            | SolveError::Ray(_)
            | SolveError::Sheet(_)
            | SolveError::Mesh(
                MeshError::Design(_) | MeshError::Thickness(_) | MeshError::Sheet(_),
            ) => Self::Problem(InvalidInput),
            SolveError::Diverged { tail, .. }
            | SolveError::NotStarted { tail, .. }
            | SolveError::Silent { tail, .. }
            | SolveError::Mesh(MeshError::Gmsh(ToolError::Failed { tail, .. }))
                if tail.contains(DISK_FULL) =>
            {
                Self::Run
            }
            SolveError::Diverged { tail, .. } | SolveError::NotStarted { tail, .. }
                if tail.contains(MEMORY_FULL) =>
            {
                Self::Machine
            }
            SolveError::Mesh(MeshError::Gmsh(ToolError::Failed { tail, .. }))
                if !tail.contains(GMSH_ERROR) =>
            {
                Self::Machine
            }
            SolveError::Mesh(
                MeshError::Defect { .. }
                | MeshError::SheetDefect(_)
                | MeshError::Gmsh(ToolError::Failed { .. }),
            ) => Self::Problem(MeshFailed),
            SolveError::Mesh(MeshError::Gmsh(error)) | SolveError::Solver(error) => match error {
                ToolError::TimedOut { .. } => Self::Problem(TimedOut),
                ToolError::TooMuchOutput { .. } => Self::Problem(TooMuchOutput),
                ToolError::Killed { .. } => Self::Machine,
                _ => Self::Run,
            },
            SolveError::NotStarted { .. } => Self::Problem(NotStarted),
            SolveError::Diverged { .. } => Self::Problem(Diverged),
            SolveError::EnergyImbalance { .. } => Self::Problem(EnergyImbalance),
            SolveError::Mesh(MeshError::Read(_))
            | SolveError::Silent { .. }
            | SolveError::Truncated { .. }
            | SolveError::Skipped { .. }
            | SolveError::Output(_) => Self::Machine,
            SolveError::Mesh(_) | SolveError::File(_) => Self::Run,
        }
    }
}

impl FailureKind {
    /// Whether the mechanics of the solve caused the failure: another run of the same attempts ends
    /// there again.
    pub(crate) fn is_repeatable(self) -> bool {
        matches!(self, Self::Diverged | Self::EnergyImbalance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_the_solver_says_is_a_failure_of_the_problem() {
        let stopped = ToolError::Stopped { name: "ccx" };
        let missing = ToolError::NotFound { kind: &crate::CCX, program: None };
        let killed = ToolError::Killed { name: "ccx", signal: 9, cpu_seconds: None };
        for (error, expected) in [
            (stopped.into(), Cause::Run),
            (missing.into(), Cause::Run),
            (killed.into(), Cause::Machine),
            (
                diverged("*ERROR: increment size smaller than minimum"),
                Cause::Problem(FailureKind::Diverged),
            ),
            (diverged("*ERROR in u_malloc: error allocating memory"), Cause::Machine),
            (diverged("No space left on device"), Cause::Run),
            (SolveError::Truncated { lambda: 0.5 }, Cause::Machine),
        ] {
            assert_eq!(Cause::of(&error), expected, "{error}");
        }
    }

    fn diverged(tail: &str) -> SolveError {
        SolveError::Diverged { lambda: 0.5, tail: tail.to_owned() }
    }
}
