//! Versions of the programs and of the code that determine the result of a window solve.

use crate::window::solve::Tools;
use serde::{Deserialize, Serialize};

/// Version of the geometry, the input deck and the evaluation. It is increased when a change of the code changes
/// results; jobs solved with an older version are then stale.
///
/// 2: D_peak is the mean over the most strained 1 % of the ligament.
pub(crate) const RECIPE_VERSION: u32 = 2;

/// Versions of the external programs that determine a result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ToolVersions {
    /// Version of gmsh.
    pub gmsh: String,
    /// Version of CalculiX.
    pub ccx: String,
}

impl ToolVersions {
    /// The versions that the programs have printed.
    pub fn of(tools: &Tools) -> Self {
        Self {
            gmsh: tools.gmsh.0.version.clone(),
            ccx: tools.ccx.0.version.clone(),
        }
    }
}

impl std::fmt::Display for ToolVersions {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "gmsh {} and ccx {}", self.gmsh, self.ccx)
    }
}
