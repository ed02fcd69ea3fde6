//! Exit codes and the error message of a command.

use app::failure::{Unfinished, message};
use std::{
    io::Write,
    process::{ExitCode, Termination},
};
use support::{caught_panic, worker_pool::NoThread};

/// The exit codes of every command; besides, 2 stands for a wrong command line and 130 for a second
/// Ctrl-C.
#[derive(Clone, Copy, Debug)]
pub enum Exit {
    /// 0: done.
    Done,
    /// 1: an error; its message is on standard error.
    Failed,
    /// 75 (EX_TEMPFAIL of sysexits.h): stopped before its work was done; the same command
    /// continues.
    Unfinished,
}

impl Exit {
    /// Prints the error of a command, if there is one.
    pub fn from_result(result: anyhow::Result<()>) -> Self {
        match result {
            Ok(()) => Self::Done,
            Err(error) => {
                eprintln!("error: {}", message(&error));
                if error.is::<Unfinished>() { Self::Unfinished } else { Self::Failed }
            }
        }
    }
}

/// Prints help, the version or the mistake of a command line, and ends the program: with 0, 2 for a
/// mistake, or 1 if it cannot be written.
pub fn print_answer(answer: &clap::Error) -> ! {
    let printed = answer.print().and_then(|()| std::io::stdout().flush());
    let code = match printed {
        Ok(()) => answer.exit_code(),
        Err(error) => {
            let _ = writeln!(std::io::stderr(), "error: cannot write to stdout: {error}");
            1
        }
    };
    std::process::exit(code)
}

/// Ends the program with an error, not a panic, when its output cannot be written (a full disk, a
/// closed terminal), and when the operating system starts no further thread.
///
/// `println!` and the thread pools of libraries panic then. The panics are recognised by their
/// messages, so that not every printed line needs an error path.
pub fn report_failures_of_the_system() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        match panic.payload_as_str().and_then(failure_of_the_system) {
            Some(reason) => {
                // Standard error may be what cannot be written.
                let _ = writeln!(std::io::stderr(), "error: {reason}");
                std::process::exit(1);
            }
            None if caught_panic::is_caught() => {}
            None => usual(panic),
        }
    }));
}

/// The reason of a panic that the operating system caused.
fn failure_of_the_system(panic: &str) -> Option<String> {
    /// The beginnings of the messages of Rayon, Polars and the standard library.
    const NO_THREAD: [&str; 3] = [
        "The global thread pool has not been initialized",
        "could not spawn threads",
        "failed to spawn thread",
    ];
    if let Some(stream) = panic.strip_prefix("failed printing to ") {
        return Some(format!("cannot write to {stream}"));
    }
    let refused = NO_THREAD.iter().any(|begin| panic.starts_with(begin));
    refused.then(|| NoThread(std::io::Error::other(panic)).to_string())
}

impl Termination for Exit {
    fn report(self) -> ExitCode {
        match self {
            Self::Done => 0.into(),
            Self::Failed => 1.into(),
            Self::Unfinished => 75.into(),
        }
    }
}
