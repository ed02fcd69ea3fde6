//! The CalculiX CrunchiX process, and how its log shows success.

use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use support::program::{Run, Tool, ToolError, ToolKind, output_file};

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
#[derive(Clone, Debug)]
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
