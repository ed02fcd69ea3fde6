//! Whether the programs a campaign needs are there, and how to get them.

use crate::ccx::CCX;
use mesher::GMSH;
use mesher::tool::{Tool, ToolError};

/// One program: where it is and its version, or how to get it.
#[derive(Debug)]
pub struct Diagnosis {
    /// The program's usual name.
    pub name: &'static str,
    /// The program, or why there is none; the message says how to get it.
    pub tool: Result<Tool, ToolError>,
}

/// Looks for gmsh and ccx.
pub fn doctor() -> [Diagnosis; 2] {
    [&GMSH, &CCX].map(|kind| Diagnosis {
        name: kind.name,
        tool: Tool::find(kind),
    })
}
