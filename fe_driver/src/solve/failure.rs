//! Kinds of failure of a solve.

use crate::solve::solve_error::SolveError;
use mesher::MeshError;
use serde::{Deserialize, Serialize};
use strum::VariantNames;
use support::program::ToolError;

/// Why a solve has no samples, or only samples of a part of its path. Its name is that of records and tables.
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
    /// The solver exited before its first increment: the program or its input deck is defective.
    NotStarted,
    /// The increment fell below the allowed minimum.
    Diverged,
    /// Terminated at the time limit.
    TimedOut,
    /// Killed by a signal that this program did not send.
    Killed,
    /// The output is damaged or incomplete.
    OutputTruncated,
    /// Energy and work disagree.
    EnergyImbalance,
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

impl FailureKind {
    /// The kind of failure of a solve; `None` if the solve did not cause the error, which then ends the whole
    /// run: a missing tool, a full disk, a stop request.
    pub fn from_error(error: &SolveError) -> Option<Self> {
        match error {
            SolveError::Material(_) | SolveError::Ray(_) | SolveError::Sheet(_) => {
                Some(Self::InvalidInput)
            }
            SolveError::Mesh(
                MeshError::Design(_) | MeshError::Thickness(_) | MeshError::Sheet(_),
            ) => Some(Self::InvalidInput),
            SolveError::Diverged { tail, .. }
            | SolveError::NotStarted { tail, .. }
            | SolveError::Mesh(MeshError::Gmsh(ToolError::Failed { tail, .. }))
                if tail.contains(DISK_FULL) =>
            {
                None
            }
            SolveError::Mesh(
                MeshError::Read(_)
                | MeshError::Defect { .. }
                | MeshError::SheetDefect(_)
                | MeshError::Gmsh(ToolError::Failed { .. }),
            ) => Some(Self::MeshFailed),
            // Killed or too slow, gmsh says nothing of the mesh: it is tried again as it was.
            SolveError::Mesh(MeshError::Gmsh(error)) | SolveError::Solver(error) => match error {
                ToolError::TimedOut { .. } => Some(Self::TimedOut),
                ToolError::Killed { .. } => Some(Self::Killed),
                ToolError::TooMuchOutput { .. } => Some(Self::OutputTruncated),
                _ => None,
            },
            SolveError::NotStarted { .. } => Some(Self::NotStarted),
            SolveError::Diverged { .. } => Some(Self::Diverged),
            SolveError::Truncated { .. } | SolveError::Skipped { .. } | SolveError::Output(_) => {
                Some(Self::OutputTruncated)
            }
            SolveError::EnergyImbalance { .. } => Some(Self::EnergyImbalance),
            SolveError::Mesh(_) | SolveError::File(_) => None,
        }
    }

    /// Whether the mechanics of the solve caused the failure: another run of the same attempts ends there again.
    pub(crate) fn is_repeatable(self) -> bool {
        matches!(self, Self::Diverged | Self::EnergyImbalance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_failures_that_a_job_causes_have_a_kind() {
        let stopped = SolveError::Solver(ToolError::Stopped { name: "ccx" });
        assert_eq!(FailureKind::from_error(&stopped), None);
        let missing = ToolError::NotFound {
            kind: &crate::CCX,
            program: None,
        };
        assert_eq!(FailureKind::from_error(&SolveError::Solver(missing)), None);
        let killed = SolveError::Solver(ToolError::Killed {
            name: "ccx",
            signal: 9,
            cpu_seconds: None,
        });
        assert_eq!(FailureKind::from_error(&killed), Some(FailureKind::Killed));
    }
}
