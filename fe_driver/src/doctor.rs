//! Checks whether the programs that a campaign needs are installed.

use crate::calculix::ccx::CCX;
use mesher::GMSH;
use support::program::{Tool, ToolError};

/// The result of the check for one program.
#[derive(Debug)]
pub struct Diagnosis {
    /// The program's usual name.
    pub name: &'static str,
    /// Path and version of the program, or an error whose message says how to install it.
    pub tool: Result<Tool, ToolError>,
}

/// Searches for gmsh and ccx.
pub fn doctor() -> [Diagnosis; 2] {
    [&GMSH, &CCX].map(|kind| Diagnosis {
        name: kind.name,
        tool: Tool::find(kind),
    })
}
