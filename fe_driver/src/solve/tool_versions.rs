//! Versions of the programs that determine the result of a solve.

use serde::{Deserialize, Serialize};

/// Versions of the external programs that determine a result.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ToolVersions {
    /// Version of gmsh.
    pub gmsh: String,
    /// Version of CalculiX.
    pub ccx: String,
}

impl std::fmt::Display for ToolVersions {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "gmsh {} and ccx {}", self.gmsh, self.ccx)
    }
}
