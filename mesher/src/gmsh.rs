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
    version_statuses: &[0],
    version_in: version,
    install: "apt-get install gmsh",
};

/// A line that is a version: `4.8.4`, `4.13.1-git-a1b2c3`. Warnings may stand before it.
fn version(printed: &str) -> Option<&str> {
    let is_version = |line: &&str| {
        let number = line.split('-').next().unwrap_or_default();
        number.contains('.') && number.split('.').all(|part| part.parse::<u32>().is_ok())
    };
    printed.lines().map(str::trim).find(is_version)
}

/// Maximum time limit: gmsh meshes a window in milliseconds and a sheet in seconds, so a longer run
/// hangs.
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

#[cfg(test)]
mod tests {
    use super::version;

    #[test]
    fn only_a_line_that_is_a_version_is_one() {
        assert_eq!(version("4.8.4"), Some("4.8.4"));
        assert_eq!(version("Warning: 2 fonts\n4.13.1-git-a1b2\n"), Some("4.13.1-git-a1b2"));
        for other in ["", "4", "  File \"gmsh\", line 4, in <module>", "Python 3.11.2", "4.x.1"] {
            assert_eq!(version(other), None, "{other}");
        }
    }
}
