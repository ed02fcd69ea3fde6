//! Kinds of failure, and what is tried next.

use crate::window_solve::SolveError;
use crate::{StepControl, WindowProblem};
use mesher::tool::ToolError;
use mesher::{MeshError, Tier};
use serde::{Deserialize, Serialize};

/// Why a job has no samples, or not all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FailureKind {
    /// The design, the material or the ray is impossible.
    InvalidInput,
    /// gmsh failed, or its mesh was refused.
    MeshFailed,
    /// The solver ended before its first increment: it is broken, or its deck is.
    NotStarted,
    /// Increments fell below the least allowed.
    Diverged,
    /// Ended at the time limit.
    TimedOut,
    /// Ended by a signal that was not ours.
    Killed,
    /// The output is damaged or ends before the solver did.
    OutputTruncated,
    /// Energy and work disagree.
    EnergyImbalance,
}

/// What a program's log says of a full disk.
const DISK_FULL: &str = "No space left on device";

/// A ray that came this far (lambda) is not worth a finer mesh.
const LONG: f64 = 0.5;

impl FailureKind {
    /// Every kind.
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

    /// The kind of a failed job; `None` if the error is no fault of the job and ends the whole
    /// run: a missing tool, a full disk, a stop.
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
                | MeshError::Gmsh(
                    ToolError::Failed { .. }
                    | ToolError::TimedOut { .. }
                    | ToolError::Killed { .. },
                ),
            ) => Some(Self::MeshFailed),
            SolveError::Solver(ToolError::TimedOut { .. }) => Some(Self::TimedOut),
            SolveError::Solver(ToolError::Killed { .. }) => Some(Self::Killed),
            SolveError::NotStarted { .. } => Some(Self::NotStarted),
            SolveError::Diverged { .. } => Some(Self::Diverged),
            SolveError::Truncated { .. } | SolveError::Skipped { .. } | SolveError::Output(_) => {
                Some(Self::OutputTruncated)
            }
            SolveError::EnergyImbalance { .. } => Some(Self::EnergyImbalance),
            SolveError::Mesh(_) | SolveError::Solver(_) | SolveError::File { .. } => None,
        }
    }

    /// What is tried after a failure of this kind at `rung` of a job asked on `tier`, which has samples up
    /// to `lambda`; `None` closes the job.
    pub fn next(self, rung: Rung, tier: Tier, lambda: f64) -> Option<Rung> {
        let next = match (self, rung) {
            (Self::InvalidInput, _) | (_, Rung::FinerTier) => None,
            (Self::MeshFailed, _) => Some(Rung::FinerTier),
            (Self::NotStarted | Self::Killed | Self::OutputTruncated, Rung::AsAsked) => {
                Some(Rung::Again)
            }
            (Self::NotStarted, _) => None,
            (_, Rung::AsAsked | Rung::Again) => Some(Rung::ShorterIncrements),
            // Mostly a snap of the ligament, which a finer mesh has too.
            (Self::Diverged, Rung::ShorterIncrements) if lambda > LONG => None,
            // A finer mesh would take longer still.
            (Self::TimedOut, Rung::ShorterIncrements) => None,
            (_, Rung::ShorterIncrements) => Some(Rung::FinerTier),
        };
        next.filter(|next| *next != Rung::FinerTier || tier.finer().is_some())
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

/// A name of no kind of failure; the message lists those there are.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("no failure is called `{0}`; there are {known}", known = FailureKind::ALL.map(FailureKind::name).join(", "))]
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

/// The retry ladder: attempts in the order they are made, each after the failure of one above.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rung {
    AsAsked,
    /// Unchanged, as the failure was not the problem's.
    Again,
    ShorterIncrements,
    /// Shorter increments on the next finer mesh.
    FinerTier,
}

impl Rung {
    /// The name used in records and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::AsAsked => "as-asked",
            Self::Again => "again",
            Self::ShorterIncrements => "shorter-increments",
            Self::FinerTier => "finer-tier",
        }
    }

    /// The problem as it is solved on this rung.
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
    fn every_ladder_ends() {
        assert_eq!(
            FailureKind::Diverged.next(Rung::ShorterIncrements, Tier::Reference, 0.0),
            None
        );
        let short =
            |lambda| FailureKind::Diverged.next(Rung::ShorterIncrements, Tier::Default, lambda);
        assert_eq!((short(0.4), short(0.6)), (Some(Rung::FinerTier), None));
        for kind in FailureKind::ALL {
            assert_eq!(kind.name().parse(), Ok(kind));
            let mut rung = Rung::AsAsked;
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
    fn only_the_failures_of_a_job_are_its_own() {
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
