//! Why an attempt failed: the message of the solver on the problem, or what happened on the
//! machine.

use mesher::MeshError;
use serde::{Deserialize, Serialize};
use strum::VariantNames;
use support::program::{ToolEnd, ToolError};
use support::{Fault, FileError, fault};

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
#[strum(parse_err_ty = Fault, parse_err_fn = unknown)]
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// The problem, according to its solver: the next attempt may help.
    Problem(FailureKind),
    /// The machine: the solver was killed, or its output is damaged or missing. The same attempt
    /// may succeed.
    Machine,
    /// A request to stop.
    Stop,
    /// What would end every other attempt too: a missing tool, a full disk.
    Run,
}

/// The error for a name that is no kind of failure.
fn unknown(name: &str) -> Fault {
    let known = FailureKind::VARIANTS.join(", ");
    fault!("unknown failure `{name}`; choose one of {known}")
}

impl FailureKind {
    /// Whether the mechanics of the solve caused the failure: another run of the same attempts ends
    /// there again.
    pub(crate) fn is_repeatable(self) -> bool {
        matches!(self, Self::Diverged | Self::EnergyImbalance)
    }
}

/// The attempts in their order, each made after an earlier one has failed by the mechanics or the
/// mesh of the problem. Which of them are made is for each kind of problem to say.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, strum::Display)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum AttemptKind {
    /// The solve as requested.
    Requested,
    /// Shorter increments on the same mesh.
    ShorterIncrements,
    /// Shorter increments on the next finer mesh.
    FinerTier,
    /// Inertia is added, which carries a sheet over a snap that has no static path.
    Dynamic,
}

/// Why a solve has no samples, or only samples of a part of the path.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
pub struct SolveError {
    /// What caused it.
    pub cause: Cause,
    /// The error in words.
    pub message: String,
}

/// The message in a program's log when the disk is full.
const DISK_FULL: &str = "No space left on device";
/// The word with which gmsh begins its message on a mesh that it cannot make.
const GMSH_ERROR: &str = "Error";
/// The message of CalculiX when the memory is full.
const MEMORY_FULL: &str = "error allocating memory";

impl Cause {
    /// The error in words.
    pub fn error(self, message: impl ToString) -> SolveError {
        SolveError { cause: self, message: message.to_string() }
    }

    /// The error of a solver that ended by itself. The end of its log decides: a full disk or
    /// memory is no fault of the problem.
    pub fn of_solver(self, what: String, tail: &str) -> SolveError {
        let cause = match self {
            _ if tail.contains(DISK_FULL) => Self::Run,
            _ if tail.contains(MEMORY_FULL) => Self::Machine,
            cause => cause,
        };
        cause.error(format!("{what}\nthe end of its log:\n{tail}"))
    }
}

impl From<ToolError> for SolveError {
    fn from(error: ToolError) -> Self {
        let cause = match error.end {
            ToolEnd::TimedOut => Cause::Problem(FailureKind::TimedOut),
            ToolEnd::TooMuchOutput => Cause::Problem(FailureKind::TooMuchOutput),
            ToolEnd::Killed => Cause::Machine,
            ToolEnd::Stopped => Cause::Stop,
            ToolEnd::Unusable | ToolEnd::Failed => Cause::Run,
        };
        cause.error(error)
    }
}

impl From<MeshError> for SolveError {
    fn from(error: MeshError) -> Self {
        let cause = match error {
            MeshError::Gmsh(ToolError { end: ToolEnd::Failed, ref message, .. }) => match () {
                () if message.contains(DISK_FULL) => Cause::Run,
                () if message.contains(GMSH_ERROR) => Cause::Problem(FailureKind::MeshFailed),
                () => Cause::Machine,
            },
            MeshError::Gmsh(error) => return error.into(),
            MeshError::Invalid(_) => Cause::Problem(FailureKind::InvalidInput),
            MeshError::Rejected(..) => Cause::Problem(FailureKind::MeshFailed),
            MeshError::Unread(_) => Cause::Machine,
            MeshError::File(_) => Cause::Run,
        };
        cause.error(error)
    }
}

impl From<FileError> for SolveError {
    fn from(error: FileError) -> Self {
        Cause::Run.error(error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_the_solver_says_is_a_failure_of_the_problem() {
        let ended = |end: ToolEnd| SolveError::from(end.error("ccx".to_owned())).cause;
        assert_eq!(ended(ToolEnd::Stopped), Cause::Stop);
        assert_eq!(ended(ToolEnd::Unusable), Cause::Run);
        assert_eq!(ended(ToolEnd::Killed), Cause::Machine);
        let problem = Cause::Problem(FailureKind::Diverged);
        for (tail, expected) in [
            ("*ERROR: increment size smaller than minimum", problem),
            ("*ERROR in u_malloc: error allocating memory", Cause::Machine),
            ("No space left on device", Cause::Run),
        ] {
            let error = problem.of_solver("the solver diverged".to_owned(), tail);
            assert_eq!(error.cause, expected, "{error}");
        }
    }
}
