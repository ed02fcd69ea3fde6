//! A deck worked on by CalculiX: its output, and why it ended before its end.
//!
//! A run is successful if the exit status is zero, the log contains the end marker, the output
//! contains every converged increment of the .sta file, and it ends at lambda = 1.

use crate::{
    Cause, FailureKind, Increment, Printed, Solution, SolveError, SolvedPath, read_printed,
    read_sta,
};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use support::FileError;
use support::program::{Run, Tool, ToolEnd, ToolError, ToolKind, output_file, remove_stale, tail};

/// The word with which CalculiX begins its message on a problem that it cannot solve, at the end of
/// its log.
const ERROR: &str = "*ERROR";

/// What CalculiX has made of a deck.
pub(crate) struct DeckRun {
    /// The process; an error if it was terminated, after which the increments that converged are
    /// valid.
    run: Result<CcxRun, ToolError>,
    /// The increments in the .sta file.
    increments: Vec<Increment>,
    /// The printed output.
    output: Vec<u8>,
    log: PathBuf,
}

impl DeckRun {
    /// Writes the deck `folder/<job>.inp` and runs it.
    pub(crate) fn new(
        ccx: &Ccx,
        deck: &str,
        folder: &Path,
        job: &str,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<Self, SolveError> {
        let [input, output, status, log] =
            ["inp", "dat", "sta", "log"].map(|kind| folder.join(job).with_extension(kind));
        std::fs::write(&input, deck).map_err(FileError::at(&input))?;
        for stale in [&output, &status] {
            remove_stale(stale).map_err(FileError::at(stale))?;
        }
        use ToolEnd::{Killed, TimedOut, TooMuchOutput};
        let run = ccx.run(folder, job, limit, stop);
        Ok(Self {
            run: match run {
                Err(error) if !matches!(error.end, TimedOut | Killed | TooMuchOutput) => {
                    return Err(error.into());
                }
                run => run,
            },
            increments: read_sta(&read_if_there(&status)?),
            output: read_if_there(&output)?,
            log,
        })
    }

    /// The solution of the printed increments, whose layout and samples are given: without samples
    /// if the output is damaged, or does not have the converged increments of the .sta file.
    pub(crate) fn solution<F: Printed, P: SolvedPath>(
        self,
        layout: &F::Layout,
        samples: impl FnOnce(&[F]) -> P,
    ) -> Solution<P> {
        let (cpu_seconds, solver_seconds, peak_memory_mib) = match &self.run {
            Ok(CcxRun { run, .. }) => (run.cpu_seconds, run.wall_seconds, run.peak_memory_mib),
            Err(error) => (error.cpu_seconds, 0.0, None),
        };
        let mut solution = Solution {
            cpu_seconds,
            solver_seconds,
            peak_memory_mib,
            iterations: self.increments.iter().map(|increment| increment.iterations).sum(),
            ..Solution::default()
        };
        let frames = read_printed(&self.output, layout).map_err(|error| error.to_string());
        let frames = frames.and_then(|frames: Vec<F>| {
            let what =
                "the solver's output and its status file disagree on the increment at lambda";
            match skipped(frames.iter().map(F::time), &self.increments) {
                Some(lambda) => Err(format!("{what} = {lambda}")),
                None => Ok(frames),
            }
        });
        solution.stopped = match frames {
            Err(damage) => Some(Cause::Machine.error(damage)),
            Ok(frames) => {
                solution.samples = samples(&frames);
                self.stopped_at(solution.samples.reached())
            }
        };
        solution
    }

    /// Why the path ends at `lambda`; `None` if that is its end.
    fn stopped_at(self, lambda: f64) -> Option<SolveError> {
        let CcxRun { run, finished } = match self.run {
            Err(error) => return Some(error.into()),
            Ok(run) => run,
        };
        if finished {
            let what = "the solver reports success, but its output ends at lambda";
            return (lambda < 1.0).then(|| Cause::Machine.error(format!("{what} = {lambda}")));
        }
        let (status, tail) = (run.status, tail(&self.log));
        let (cause, what) = match (tail.contains(ERROR), self.increments.is_empty()) {
            (false, _) => {
                let what = "says neither that it has finished nor why not";
                (Cause::Machine, format!("the solver ended with {status} and {what}"))
            }
            (true, true) => {
                let what = format!("the solver refused its input ({status})");
                (Cause::Problem(FailureKind::NotStarted), what)
            }
            (true, false) => {
                let what = format!("the solver diverged at lambda = {lambda}");
                (Cause::Problem(FailureKind::Diverged), what)
            }
        };
        Some(cause.of_solver(what, &tail))
    }
}

/// The time that the deck which runs in `folder` has reached.
pub(crate) fn time_reached(folder: &Path, job: &str) -> f64 {
    let status = output_file(&folder.join(job).with_extension("sta")).unwrap_or_default();
    let increments = read_sta(&status);
    increments.last().map_or(0.0, |increment| increment.lambda)
}

/// The first increment at which the output and the converged increments of the .sta file disagree:
/// it is missing in the output, or it was printed although it did not converge.
///
/// A solver that was terminated may not have written all increments to both files: only those in
/// both are compared. Increments missing at the end are detected by the last lambda.
fn skipped(times: impl Iterator<Item = f64>, increments: &[Increment]) -> Option<f64> {
    let converged = increments.iter().filter(|increment| increment.converged);
    let mut pairs = times.zip(converged).map(|(time, a)| (time, a.lambda));
    // Numbers in the .sta file have six digits.
    let found = pairs.find(|(printed, expected)| (printed - expected).abs() > 1e-5 * printed);
    found.map(|(printed, expected)| printed.min(expected))
}

/// The bytes of a file; empty if ccx did not write it.
pub(crate) fn read_if_there(path: &Path) -> Result<Vec<u8>, FileError> {
    output_file(path).map_err(FileError::at(path))
}

/// How to find ccx.
pub static CCX: ToolKind = ToolKind {
    name: "ccx",
    variable: "KIRIGAMI_CCX",
    version_flag: "-v",
    // It ends as after any run, by the `stop 201` of its Fortran; wrappers end with 0.
    version_statuses: &[0, 201],
    version_in: |printed| {
        let (_, version) = printed.split_once("This is Version ")?;
        version.split_whitespace().next()
    },
    install: "apt-get install calculix-ccx",
};

/// The last line that ccx prints when it has reached the end of the deck.
const END_MARKER: &str = "Job finished";

/// The CalculiX program.
#[derive(Debug)]
pub struct Ccx(pub Tool);

/// Result of a completed run of ccx.
#[derive(Debug)]
pub struct CcxRun {
    /// Exit status, times and memory of the process.
    pub run: Run,
    /// Whether the log contains the end marker and the exit status is zero.
    pub finished: bool,
}

impl Ccx {
    /// Finds ccx by `KIRIGAMI_CCX` or on PATH.
    pub fn find() -> Result<Self, ToolError> {
        Tool::find(&CCX).map(Self)
    }

    /// The program at a path.
    pub fn at(program: &Path) -> Result<Self, ToolError> {
        Tool::at(&CCX, program).map(Self)
    }

    /// Runs `folder/<job>.inp`. The output is in `folder/<job>.dat`, the log in `folder/<job>.log`.
    pub fn run(
        &self,
        folder: &Path,
        job: &str,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<CcxRun, ToolError> {
        let log = folder.join(job).with_extension("log");
        let run = self.0.run(&["-i", job], folder, &log, limit, stop)?;
        let bytes = output_file(&log).unwrap_or_default();
        let text = String::from_utf8_lossy(&bytes);
        Ok(CcxRun { finished: run.status.success() && text.contains(END_MARKER), run })
    }
}

#[cfg(test)]
mod tests {
    use super::CCX;
    use super::*;

    #[test]
    fn a_missing_or_surplus_increment_is_found() {
        let status = [(0.0, false), (0.25, true), (0.333333, true), (1.0, true)];
        let increments =
            status.map(|(lambda, converged)| Increment { lambda, iterations: 3, converged });
        let skipped = |printed: &[f64]| skipped(printed.iter().copied(), &increments);
        assert_eq!(skipped(&[0.25, 1.0 / 3.0, 1.0]), None);
        assert_eq!(skipped(&[0.25, 1.0 / 3.0]), None);
        assert_eq!(skipped(&[0.25, 1.0]), Some(0.333333));
        assert_eq!(skipped(&[0.25, 0.3, 1.0 / 3.0, 1.0]), Some(0.3));
    }

    #[test]
    fn releases_and_builds_between_them_have_a_version() {
        for (printed, version) in [
            ("\nThis is Version 2.20\n\n", Some("2.20")),
            ("\nThis is Version 2.23\n", Some("2.23")),
            ("This is Version DEVELOPMENT\n", Some("DEVELOPMENT")),
            ("This is Version \n", None),
            ("ccx: error while loading shared libraries: libspooles.so.2.2", None),
            ("", None),
        ] {
            assert_eq!((CCX.version_in)(printed), version, "{printed}");
        }
    }
}
