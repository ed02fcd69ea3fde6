//! Errors of external programs.

use crate::program::ToolKind;
use crate::program::process_group::MAX_FILE_MIB;
use std::path::PathBuf;
use std::process::ExitStatus;
use std::time::Duration;

/// Why an external program gave no result.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum ToolError {
    #[error(
        "{name} was not found{at}; install it ({install}) or set {variable} to its path",
        name = .kind.name,
        at = .program.as_ref().map(|p| format!(" at {}", p.display())).unwrap_or(" on PATH".into()),
        install = .kind.install,
        variable = .kind.variable
    )]
    NotFound {
        kind: &'static ToolKind,
        /// The path that was given, `None` if PATH was searched.
        program: Option<PathBuf>,
    },
    #[error("cannot run {program}: {source}", program = .program.display())]
    Start { program: PathBuf, source: std::io::Error },
    #[error(
        "{program} cannot be used as {name}: `{flag}` ended with {status} and printed no version of it, but {printed}; install it \
         ({install}) or set {variable} to its path",
        program = .program.display(),
        name = .kind.name,
        flag = .kind.version_flag,
        printed = if .printed.is_empty() { "nothing".into() } else { format!("`{}`", .printed) },
        install = .kind.install,
        variable = .kind.variable
    )]
    NoVersion {
        kind: &'static ToolKind,
        program: PathBuf,
        status: ExitStatus,
        /// The end of what it printed.
        printed: String,
    },
    #[error("{name} was terminated at its time limit of {limit} s", limit = .limit.as_secs_f64())]
    TimedOut {
        name: &'static str,
        limit: Duration,
        /// See [`Run::cpu_seconds`](crate::program::Run::cpu_seconds).
        cpu_seconds: Option<f64>,
    },
    #[error("{name} was killed by signal {signal} (out of memory, or killed by hand)")]
    Killed {
        name: &'static str,
        signal: i32,
        /// See [`Run::cpu_seconds`](crate::program::Run::cpu_seconds).
        cpu_seconds: Option<f64>,
    },
    #[error(
        "{name} wrote a file of over {MAX_FILE_MIB} MiB, or over the limit of `ulimit -f`, and was terminated: no window \
         needs 1 GiB, so it would fill the disk"
    )]
    TooMuchOutput {
        name: &'static str,
        /// See [`Run::cpu_seconds`](crate::program::Run::cpu_seconds).
        cpu_seconds: Option<f64>,
    },
    #[error("{name} was stopped on request")]
    Stopped { name: &'static str },
    #[error("{name} failed with {status}; the end of its log:\n{tail}")]
    Failed { name: &'static str, status: ExitStatus, tail: String },
}

impl ToolError {
    /// CPU time used until the program was terminated (s), if the operating system reports it.
    pub fn cpu_seconds(&self) -> Option<f64> {
        match self {
            Self::TimedOut { cpu_seconds, .. }
            | Self::Killed { cpu_seconds, .. }
            | Self::TooMuchOutput { cpu_seconds, .. } => *cpu_seconds,
            _ => None,
        }
    }
}
