//! Why an attempt at a solve has failed.

use crate::{Cause, FailureKind};
use mesher::MeshError;
use support::file_error::FileError;
use support::program::{ToolEnd, ToolError};

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

    /// The error of a solver that ended by itself. The end of its log decides: a full disk or a full
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
