//! The gmsh process: generates a second-order plane mesh from a script.

use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use support::program::{Tool, ToolError, ToolKind};

/// How to find gmsh.
pub static GMSH: ToolKind = ToolKind {
    name: "gmsh",
    variable: "KIRIGAMI_GMSH",
    version_flag: "--version",
    install: "apt-get install gmsh",
};

/// Maximum time limit: gmsh meshes a window in milliseconds and a sheet in seconds, so a longer run hangs.
const LIMIT: Duration = Duration::from_secs(60);

/// The gmsh program.
#[derive(Clone, Debug)]
pub struct Gmsh(pub Tool);

impl Gmsh {
    /// Finds gmsh by `KIRIGAMI_GMSH` or on PATH.
    pub fn find() -> Result<Self, ToolError> {
        Tool::find(&GMSH).map(Self)
    }

    /// The program at a path.
    pub fn at(program: &Path) -> Result<Self, ToolError> {
        Tool::at(&GMSH, program).map(Self)
    }

    /// Meshes `folder/<name>.geo` with 8-node quadrilaterals, to `folder/<name>.msh`.
    pub(crate) fn mesh(
        &self,
        folder: &Path,
        name: &str,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<(), ToolError> {
        let log = folder.join("gmsh.log");
        let [msh, geo] = ["msh", "geo"].map(|kind| format!("{name}.{kind}"));
        let arguments = [
            "-2",
            // Errors only: the end of the log says why there is no mesh.
            "-v",
            "1",
            "-order",
            "2",
            "-setnumber",
            "Mesh.SecondOrderIncomplete",
            "1",
            "-nt",
            "1",
            "-format",
            "msh22",
            "-o",
            &msh,
            &geo,
        ];
        let limit = limit.min(LIMIT);
        let run = self.0.run(&arguments, folder, &log, limit, stop)?;
        self.0.expect_success(run, &log)
    }
}
