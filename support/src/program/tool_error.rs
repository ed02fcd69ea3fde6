//! Errors of external programs.

/// How a program ended without a result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToolEnd {
    /// It was not found, cannot be started, or is another program.
    Unusable,
    /// Terminated at its time limit.
    TimedOut,
    /// Killed by a signal.
    Killed,
    /// Terminated because it wrote a file that is larger than any result.
    TooMuchOutput,
    /// Stopped on request.
    Stopped,
    /// It failed; the message quotes the end of its log.
    Failed,
}

/// Why an external program gave no result.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
pub struct ToolError {
    /// How it ended.
    pub end: ToolEnd,
    /// The error in words.
    pub message: String,
    /// CPU time used until it was terminated (s), if the operating system reports it.
    pub cpu_seconds: Option<f64>,
}

impl ToolEnd {
    /// The error of a program that ended in this way.
    pub fn error(self, message: String) -> ToolError {
        ToolError { end: self, message, cpu_seconds: None }
    }
}
