//! Kinds of failure, and the retry that follows each.

use crate::window::solve::SolveError;
use crate::window::solve::WindowProblem;
use crate::window::step_control::StepControl;
use mesher::{MeshError, Tier};
use serde::{Deserialize, Serialize};
use support::program::ToolError;

/// Why a job has no samples, or only samples of a part of its ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FailureKind {
    /// The design, the material or the ray is impossible.
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

/// The message in a program's log when the disk is full.
const DISK_FULL: &str = "No space left on device";

/// A ray that diverges beyond this lambda is not retried on a finer mesh.
const LONG: f64 = 0.5;

impl FailureKind {
    /// All kinds.
    pub const ALL: [Self; 8] = [
        Self::InvalidInput,
        Self::MeshFailed,
        Self::NotStarted,
        Self::Diverged,
        Self::TimedOut,
        Self::Killed,
        Self::OutputTruncated,
        Self::EnergyImbalance,
    ];

    /// The kind of failure of a job; `None` if the job did not cause the error, which then ends the whole
    /// run: a missing tool, a full disk, a stop request.
    pub fn of(error: &SolveError) -> Option<Self> {
        match error {
            SolveError::Material(_) | SolveError::Ray(_) => Some(Self::InvalidInput),
            SolveError::Mesh(MeshError::Design(_) | MeshError::Thickness(_)) => {
                Some(Self::InvalidInput)
            }
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
            SolveError::Mesh(_) | SolveError::File { .. } => None,
        }
    }

    /// The retry after a failure of this kind at step `rung` of a job requested on `tier`, which has samples up
    /// to `lambda`; `None` closes the job.
    pub fn next(self, rung: RetryStep, tier: Tier, lambda: f64) -> Option<RetryStep> {
        let next = match (self, rung) {
            (Self::InvalidInput, _) | (_, RetryStep::FinerTier) => None,
            (Self::MeshFailed, _) => Some(RetryStep::FinerTier),
            (Self::NotStarted | Self::Killed | Self::OutputTruncated, RetryStep::AsAsked) => {
                Some(RetryStep::Again)
            }
            (Self::NotStarted, _) => None,
            (_, RetryStep::AsAsked | RetryStep::Again) => Some(RetryStep::ShorterIncrements),
            // The usual cause is a snap of the ligament, which also occurs on a finer mesh.
            (Self::Diverged, RetryStep::ShorterIncrements) if lambda > LONG => None,
            // A finer mesh would take even longer.
            (Self::TimedOut, RetryStep::ShorterIncrements) => None,
            (_, RetryStep::ShorterIncrements) => Some(RetryStep::FinerTier),
        };
        next.filter(|next| *next != RetryStep::FinerTier || tier.finer().is_some())
    }

    /// The name used in records and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::InvalidInput => "invalid-input",
            Self::MeshFailed => "mesh-failed",
            Self::NotStarted => "not-started",
            Self::Diverged => "diverged",
            Self::TimedOut => "timed-out",
            Self::Killed => "killed",
            Self::OutputTruncated => "output-truncated",
            Self::EnergyImbalance => "energy-imbalance",
        }
    }
}

impl std::fmt::Display for FailureKind {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.pad(self.name())
    }
}

/// An unknown name of a failure kind; the message lists the known ones.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("unknown failure `{0}`; choose one of {known}", known = FailureKind::ALL.map(FailureKind::name).join(", "))]
pub struct UnknownFailure(String);

impl std::str::FromStr for FailureKind {
    type Err = UnknownFailure;

    fn from_str(name: &str) -> Result<Self, UnknownFailure> {
        Self::ALL
            .into_iter()
            .find(|kind| kind.name() == name)
            .ok_or_else(|| UnknownFailure(name.to_owned()))
    }
}

/// The retry ladder: attempts in their order, each made after an earlier one has failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RetryStep {
    /// The problem as given.
    AsAsked,
    /// Unchanged, because the problem did not cause the failure.
    Again,
    /// Shorter increments on the same mesh.
    ShorterIncrements,
    /// Shorter increments on the next finer mesh.
    FinerTier,
}

impl RetryStep {
    /// The name used in records and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::AsAsked => "as-asked",
            Self::Again => "again",
            Self::ShorterIncrements => "shorter-increments",
            Self::FinerTier => "finer-tier",
        }
    }

    /// The problem that is solved at this step.
    pub fn problem(self, asked: &WindowProblem) -> WindowProblem {
        let mut problem = asked.clone();
        if matches!(self, Self::ShorterIncrements | Self::FinerTier) {
            problem.step = StepControl::patient();
        }
        if self == Self::FinerTier {
            problem.tier = asked.tier.finer().unwrap_or(asked.tier);
        }
        problem
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_retry_ladder_ends() {
        assert_eq!(
            FailureKind::Diverged.next(RetryStep::ShorterIncrements, Tier::Reference, 0.0),
            None
        );
        let short = |lambda| {
            FailureKind::Diverged.next(RetryStep::ShorterIncrements, Tier::Default, lambda)
        };
        assert_eq!((short(0.4), short(0.6)), (Some(RetryStep::FinerTier), None));
        for kind in FailureKind::ALL {
            assert_eq!(kind.name().parse(), Ok(kind));
            let mut rung = RetryStep::AsAsked;
            let mut attempts = 1;
            while let Some(next) = kind.next(rung, Tier::Default, 0.0) {
                assert_ne!(next, rung);
                rung = next;
                attempts += 1;
            }
            assert!(attempts <= 4, "{kind}: {attempts}");
        }
    }

    #[test]
    fn only_failures_that_a_job_causes_have_a_kind() {
        let stopped = SolveError::Solver(ToolError::Stopped { name: "ccx" });
        assert_eq!(FailureKind::of(&stopped), None);
        let missing = ToolError::NotFound {
            kind: &crate::CCX,
            program: None,
        };
        assert_eq!(FailureKind::of(&SolveError::Solver(missing)), None);
        let killed = SolveError::Solver(ToolError::Killed {
            name: "ccx",
            signal: 9,
            cpu_seconds: None,
        });
        assert_eq!(FailureKind::of(&killed), Some(FailureKind::Killed));
    }
}
