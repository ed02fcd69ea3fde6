//! CalculiX CrunchiX: the process and what its log says.

use mesher::tool::{Run, Tool, ToolError, ToolKind};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// How ccx is found.
pub static CCX: ToolKind = ToolKind {
    name: "ccx",
    variable: "KIRIGAMI_CCX",
    version_flag: "-v",
    install: "apt-get install calculix-ccx",
};

/// What ccx prints last when it has come to the end of the deck.
const END_MARKER: &str = "Job finished";

/// The CalculiX program.
#[derive(Clone, Debug)]
pub struct Ccx(pub Tool);

/// How a run of ccx ended.
#[derive(Debug)]
pub struct CcxRun {
    pub run: Run,
    /// Whether it says that it came to the end of the deck, and left with status zero.
    pub finished: bool,
}

impl Ccx {
    /// Found by `KIRIGAMI_CCX` or on PATH.
    pub fn find() -> Result<Self, ToolError> {
        Tool::find(&CCX).map(Self)
    }

    /// The program at a path.
    pub fn at(program: &Path) -> Result<Self, ToolError> {
        Tool::at(&CCX, program).map(Self)
    }

    /// Runs `folder/<job>.inp`; output in `folder/<job>.dat`, log in `folder/<job>.log`.
    pub fn run(
        &self,
        folder: &Path,
        job: &str,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<CcxRun, ToolError> {
        let log = folder.join(job).with_extension("log");
        let run = self.0.run(&["-i", job], folder, &log, limit, stop)?;
        let bytes = std::fs::read(&log).unwrap_or_default();
        let text = String::from_utf8_lossy(&bytes);
        Ok(CcxRun {
            finished: run.status.success() && text.contains(END_MARKER),
            run,
        })
    }
}
