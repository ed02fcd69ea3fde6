//! External programs: found, checked for their version, run under a time limit, never orphaned.
//!
//! A program runs in its own process group. Its output goes to a log file, because a pipe that is
//! not read would block it. It is terminated by SIGTERM, then SIGKILL, sent to the whole group: at
//! its time limit and when the caller sets the stop flag. When the caller dies, the program itself
//! is killed. All that it started is killed when it has ended, and what a killed caller left is
//! killed before the next program runs in the same folder.

mod output_files;
mod process_group;
mod tool_error;

pub use output_files::{output_file, remove_stale, tail};
pub use tool_error::{ToolEnd, ToolError};

use crate::processes::memory_mib;
use crate::program::process_group::{Group, MAX_FILE_MIB, POLL};
use crate::scratch::Scratch;
use crate::verbose;
use nix::sys::signal::Signal;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::ExitStatus;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How to find a program.
#[derive(Debug)]
pub struct ToolKind {
    /// The program's usual name.
    pub name: &'static str,
    /// Environment variable that overrides the search with a path.
    pub variable: &'static str,
    /// The argument that makes it print its version.
    pub version_flag: &'static str,
    /// Its exit statuses after that.
    pub version_statuses: &'static [i32],
    /// The version in what it prints; `None` if another program has printed it.
    pub version_in: fn(&str) -> Option<&str>,
    /// Command that installs it.
    pub install: &'static str,
}

/// A program that was found and has printed its version.
#[derive(Debug)]
pub struct Tool {
    /// How the program is found.
    pub kind: &'static ToolKind,
    /// Absolute path of the program.
    pub program: PathBuf,
    /// The version that the program printed.
    pub version: String,
}

/// Result of a completed run, whether it succeeded or not.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// Exit status of the process.
    pub status: ExitStatus,
    /// User and system time of the process (s), if the operating system reports it.
    pub cpu_seconds: Option<f64>,
    /// Wall time from start to end (s), without that in which this program was suspended.
    pub wall_seconds: f64,
    /// Maximum resident memory observed during the run (MiB), if the operating system reports it.
    pub peak_memory_mib: Option<f64>,
}

/// Time limit of the version query.
const VERSION_LIMIT: Duration = Duration::from_secs(30);
/// Maximum time between two polls that counts. In a longer time this program was itself suspended,
/// and with it the program that it watches.
const LONGEST_POLL: Duration = Duration::from_secs(1);
/// Maximum delay between the death of a program by a signal and the stop request that the same
/// signal causes.
const SAME_SIGNAL: Duration = Duration::from_millis(500);

impl ToolKind {
    fn not_found(&self, place: &str) -> ToolError {
        let Self { name, variable, install, .. } = self;
        ToolEnd::Unusable.error(format!(
            "{name} was not found {place}; install it ({install}) or set {variable} to its path"
        ))
    }
}

impl Tool {
    /// Finds the program by its environment variable or on PATH.
    pub fn find(kind: &'static ToolKind) -> Result<Self, ToolError> {
        match std::env::var_os(kind.variable) {
            Some(program) => Self::at(kind, Path::new(&program)),
            None => {
                Self::at(kind, &search_path(kind.name).ok_or_else(|| kind.not_found("on PATH"))?)
            }
        }
    }

    /// The program at a path.
    pub fn at(kind: &'static ToolKind, program: &Path) -> Result<Self, ToolError> {
        let mut tool = Self {
            kind,
            program: std::path::absolute(program)
                .ok()
                .filter(|program| program.is_file())
                .ok_or_else(|| kind.not_found(&format!("at {}", program.display())))?,
            version: String::new(),
        };
        tool.version = tool.ask_version()?;
        Ok(tool)
    }

    fn ask_version(&self) -> Result<String, ToolError> {
        let folder = Scratch::new().map_err(|source| self.cannot_start(source))?;
        let log = folder.path().join("version.log");
        let arguments = [self.kind.version_flag];
        let run =
            self.run(&arguments, folder.path(), &log, VERSION_LIMIT, &AtomicBool::new(false))?;
        let printed = tail(&log);
        let answered =
            (run.status.code()).is_some_and(|status| self.kind.version_statuses.contains(&status));
        let version = (self.kind.version_in)(&printed).filter(|_| answered);
        version.map(str::to_owned).ok_or_else(|| {
            let ToolKind { name, variable, version_flag, install, .. } = self.kind;
            let (program, status) = (self.program.display(), run.status);
            let printed = match &*printed {
                "" => "nothing".to_owned(),
                printed => format!("`{printed}`"),
            };
            ToolEnd::Unusable.error(format!(
                "{program} cannot be used as {name}: `{version_flag}` ended with {status} and printed no version of \
                 it, but {printed}; install it ({install}) or set {variable} to its path"
            ))
        })
    }

    /// Runs the program in `folder`, with its output in `log`, until it exits by itself.
    ///
    /// A non-zero exit status is not an error here: see [`Tool::expect_success`].
    pub fn run(
        &self,
        arguments: &[&str],
        folder: &Path,
        log: &Path,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<Run, ToolError> {
        let line = || {
            let (program, folder) = (self.program.display(), folder.display());
            format!("{program} {} in {folder}", arguments.join(" "))
        };
        verbose::note(|| format!("running {}", line()));
        let start = Instant::now();
        let outcome = self.watch(arguments, folder, log, limit, stop);
        verbose::note(|| {
            let seconds = start.elapsed().as_secs_f64();
            let how = match &outcome {
                Ok(run) => run.status.to_string(),
                Err(error) => error.to_string(),
            };
            format!("ended after {seconds:.2} s ({how}): {}", line())
        });
        outcome
    }

    /// Runs the program to its end, its time limit or a stop, whichever comes first.
    fn watch(
        &self,
        arguments: &[&str],
        folder: &Path,
        log: &Path,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<Run, ToolError> {
        let (mut last, mut running) = (Instant::now(), Duration::ZERO);
        let mut group = Group::spawn(&self.program, arguments, folder, log)
            .map_err(|source| self.cannot_start(source))?;
        let name = self.kind.name;
        let stopped = || ToolEnd::Stopped.error(format!("{name} was stopped on request"));
        let mut peak_memory_mib = None;
        while !group.has_ended() {
            peak_memory_mib = memory_mib(group.id()).or(peak_memory_mib);
            if stop.load(Ordering::Relaxed) {
                group.end();
                return Err(stopped());
            }
            running += last.elapsed().min(LONGEST_POLL);
            last = Instant::now();
            if running > limit {
                group.end();
                let limit = limit.as_secs_f64();
                let message = format!("{name} was terminated at its time limit of {limit} s");
                let cpu_seconds = group.cpu_seconds();
                return Err(ToolError { cpu_seconds, ..ToolEnd::TimedOut.error(message) });
            }
            std::thread::sleep(POLL.min(Duration::from_millis(1) + running / 10));
        }
        running += last.elapsed().min(LONGEST_POLL);
        let cpu_seconds = group.cpu_seconds();
        let status = group.wait().map_err(|source| self.cannot_start(source))?;
        if status.signal() == Some(Signal::SIGXFSZ as i32) {
            let message = format!(
                "{name} wrote a file of over {MAX_FILE_MIB} MiB, or over the limit of `ulimit -f`, and was terminated: \
                 no window needs 1 GiB, so it would fill the disk"
            );
            return Err(ToolError { cpu_seconds, ..ToolEnd::TooMuchOutput.error(message) });
        }
        if let Some(signal) = status.signal().or_else(|| signal_of_child(status)) {
            // A service manager or a scheduler signals all processes of a job at once: the request
            // to stop may arrive a moment after the program died of the same signal.
            let patience = Instant::now() + SAME_SIGNAL;
            while Instant::now() < patience {
                if stop.load(Ordering::Relaxed) {
                    return Err(stopped());
                }
                std::thread::sleep(POLL);
            }
            let message =
                format!("{name} was killed by signal {signal} (out of memory, or killed by hand)");
            return Err(ToolError { cpu_seconds, ..ToolEnd::Killed.error(message) });
        }
        Ok(Run { status, cpu_seconds, wall_seconds: running.as_secs_f64(), peak_memory_mib })
    }

    /// Returns an error that quotes the end of the log if the exit status is not zero.
    pub fn expect_success(&self, run: Run, log: &Path) -> Result<(), ToolError> {
        if run.status.success() {
            return Ok(());
        }
        let (name, status, tail) = (self.kind.name, run.status, tail(log));
        Err(ToolEnd::Failed
            .error(format!("{name} failed with {status}; the end of its log:\n{tail}")))
    }

    fn cannot_start(&self, source: std::io::Error) -> ToolError {
        let program = self.program.display();
        ToolEnd::Unusable.error(format!("cannot run {program}: {source}"))
    }
}

/// The signal that killed the child of a shell, by which the shell exits: 128 and its number.
fn signal_of_child(status: ExitStatus) -> Option<i32> {
    let signal = status.code()? - 128;
    Signal::try_from(signal).ok().map(|signal| signal as i32)
}

/// The first executable file with this name on PATH.
fn search_path(name: &str) -> Option<PathBuf> {
    use std::os::unix::fs::PermissionsExt;
    std::env::split_paths(&std::env::var_os("PATH")?).map(|folder| folder.join(name)).find(|path| {
        path.metadata().is_ok_and(|m| m.is_file() && m.permissions().mode() & 0o111 != 0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::processes::FOLDER;
    use crate::program::process_group::GRACE;
    use std::process::Command;

    static SHELL: ToolKind = ToolKind {
        name: "sh",
        variable: "KIRIGAMI_NO_SUCH_VARIABLE",
        version_flag: "--version",
        version_statuses: &[0],
        version_in: |printed| printed.strip_prefix("sh "),
        install: "apt-get install dash",
    };

    fn shell() -> Tool {
        Tool { kind: &SHELL, program: "/bin/sh".into(), version: "1".into() }
    }

    fn run(script: &str, limit: Duration, stop: bool) -> (Result<Run, ToolError>, String) {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("log");
        let stop = AtomicBool::new(stop);
        let result = shell().run(&["-c", script], folder.path(), &log, limit, &stop);
        (result, tail(&log))
    }

    const LONG: Duration = Duration::from_secs(60);

    #[test]
    fn a_run_reports_status_log_time_and_memory() {
        let count = "i=0; while [ $i -lt 200000 ]; do i=$((i+1)); done";
        let script = format!("{count}; echo out; echo err >&2; exit 3");
        let (ended, log) = run(&script, LONG, false);
        let ended = ended.unwrap();
        assert_eq!(ended.status.code(), Some(3));
        assert_eq!(log, "out\nerr");
        let cpu = ended.cpu_seconds.unwrap();
        assert!(cpu > 0.0 && cpu < 10.0, "{cpu}");
        assert!(ended.wall_seconds > 0.0);
        let memory = ended.peak_memory_mib.unwrap();
        assert!(memory > 0.1 && memory < 1000.0, "{memory}");
    }

    #[test]
    fn a_hanging_program_is_terminated_with_its_children() {
        let script = "trap '' TERM; sleep 1000 & echo $!; while true; do :; done";
        let (ended, log) = run(script, Duration::from_millis(200), false);
        let error = ended.unwrap_err();
        assert_eq!(error.end, ToolEnd::TimedOut, "{error}");
        assert!(error.cpu_seconds.unwrap() > 0.0, "{error:?}");
        assert_ends(&log);
    }

    /// The process with the number `pid` ends soon.
    fn assert_ends(pid: &str) {
        let child: i32 = pid.trim().parse().unwrap();
        let gone = || !Path::new(&format!("/proc/{child}")).exists() || is_zombie(child);
        let deadline = Instant::now() + GRACE;
        while !gone() && Instant::now() < deadline {
            std::thread::sleep(POLL);
        }
        assert!(gone());
    }

    fn is_zombie(pid: i32) -> bool {
        std::fs::read_to_string(format!("/proc/{pid}/stat")).is_ok_and(|stat| stat.contains(") Z"))
    }

    /// Also if it left the process group and the session, and the program succeeded.
    #[test]
    fn a_detached_process_does_not_outlive_the_program() {
        let (ended, log) = run("setsid sleep 1000 & echo $!; sleep 0.2", LONG, false);
        assert!(ended.unwrap().status.success());
        assert_ends(&log);
    }

    #[test]
    fn what_a_killed_run_left_is_ended_before_the_next() {
        let folder = tempfile::tempdir().unwrap();
        let mut command = Command::new("setsid");
        command.args(["sh", "-c", "sleep 1000; true"]);
        let mut left = command.env(FOLDER, folder.path()).spawn().unwrap();
        // The process has the environment of this test until exec.
        std::thread::sleep(Duration::from_millis(200));
        let log = folder.path().join("log");
        let never = AtomicBool::new(false);
        let next = shell().run(&["-c", "true"], folder.path(), &log, LONG, &never);
        next.unwrap();
        assert_eq!(left.wait().unwrap().signal(), Some(9));
    }

    #[test]
    fn a_program_that_fills_the_disk_is_ended() {
        let (ended, _) = run("exec truncate -s 2G huge", LONG, false);
        let error = ended.unwrap_err();
        assert_eq!(error.end, ToolEnd::TooMuchOutput, "{error}");
    }

    #[test]
    fn signals_and_stops_are_distinguished() {
        let (killed, _) = run("kill -9 $$", LONG, false);
        let is = |ended: Result<Run, ToolError>, end, said: &str| {
            let error = ended.unwrap_err();
            error.end == end && error.message.contains(said)
        };
        assert!(is(killed, ToolEnd::Killed, "signal 9 "));
        // A shell that does not replace itself by the program says by its exit code how that ended;
        // 201 is no signal.
        let (wrapped, _) = run("sh -c 'kill -15 $$'; exit $?", LONG, false);
        assert!(is(wrapped, ToolEnd::Killed, "signal 15 "));
        let (refused, _) = run("exit 201", LONG, false);
        assert_eq!(refused.unwrap().status.code(), Some(201));
        let (stopped, _) = run("sleep 1000", LONG, true);
        assert!(is(stopped, ToolEnd::Stopped, "on request"));
    }

    /// A program is what its name says only if it prints a version and exits as after one.
    #[test]
    fn a_program_that_cannot_print_its_version_is_refused_with_what_it_printed() {
        let folder = tempfile::tempdir().unwrap();
        let program = folder.path().join("sh");
        let found = |script: &str| {
            use std::os::unix::fs::PermissionsExt;
            std::fs::write(&program, format!("#!/bin/sh\n{script}\n")).unwrap();
            let executable = std::fs::Permissions::from_mode(0o755);
            std::fs::set_permissions(&program, executable).unwrap();
            Tool::at(&SHELL, &program)
        };
        assert_eq!(found("echo sh 4.1").unwrap().version, "4.1");
        let traceback = "echo 'File \"gmsh\", line 4, in <module>'; exit 1";
        let no_library = "echo 'libGLU.so.1: cannot open' >&2; exit 127";
        for (script, said) in [
            (traceback, "line 4, in"),
            (no_library, "libGLU.so.1"),
            ("echo sh 4.1; exit 1", "sh 4.1"),
            ("echo bash 5", "bash 5"),
            (":", "nothing"),
        ] {
            let error = found(script).unwrap_err();
            assert!(error.message.contains("printed no version"), "{error}");
            assert!(error.message.contains(said), "{error}");
        }
    }

    #[test]
    fn the_error_for_a_missing_program_says_how_to_install_it() {
        let missing = "/no/such/program";
        let error = Tool::at(&SHELL, Path::new(missing)).unwrap_err();
        let message = error.to_string();
        for part in [missing, "apt-get install dash", "KIRIGAMI_NO_SUCH_VARIABLE"] {
            assert!(message.contains(part), "{message}");
        }
    }
}
