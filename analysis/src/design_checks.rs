//! What was measured of the design of a run after its search. The folder of the run keeps it, and
//! its report states it.

use crate::levels::Levels;
use design::pattern::design_vector::DesignVector;
use scene::Posture;
use serde::{Deserialize, Serialize};
use std::io;
use std::path::Path;
use support::severity::Finding;
use support::{FileError, regular_file, sealed_json};

/// The checks, in the folder of a run.
pub const CHECKS_FILE: &str = "checks.json";

/// What was measured of a design.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct DesignChecks {
    /// What its levels cost, and how far they are from the finest one.
    pub levels: Option<Levels>,
    /// Its whole sheet by finite elements.
    pub whole_sheet: Option<WholeSheet>,
}

/// A whole sheet by finite elements, compared with the hinge law.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct WholeSheet {
    /// What kept the panels in their plane.
    pub support: Posture,
    /// Largest tilt of a panel on the path (deg).
    pub tilt_deg: f64,
    /// Distance of the panel corners in space at the end of the path (mm): root mean square and
    /// maximum.
    pub corners: [f64; 2],
    /// Load there (N), by the hinge law and by finite elements.
    pub load: Option<[f64; 2]>,
    /// What a person should know.
    pub findings: Vec<Finding>,
}

/// The file: the checks with the design that they are of.
#[derive(Serialize, Deserialize)]
struct ChecksOfDesign {
    design: DesignVector,
    checks: DesignChecks,
}

impl DesignChecks {
    /// The checks of a design in the folder of its run; empty if there are none, or if those there
    /// are of an earlier design.
    pub fn read(folder: &Path, design: &DesignVector) -> Result<Self, FileError> {
        let path = folder.join(CHECKS_FILE);
        let text = match regular_file::read(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Self::default()),
            text => text.map_err(FileError::at(&path))?,
        };
        let kept = sealed_json::from_slice::<ChecksOfDesign>(&text).map_err(io::Error::other);
        let kept = kept.map_err(FileError::at(&path))?;
        Ok(if kept.design == *design { kept.checks } else { Self::default() })
    }

    /// Writes the checks of a design to the folder of its run.
    pub fn write(self, folder: &Path, design: &DesignVector) -> Result<(), FileError> {
        let kept = ChecksOfDesign { design: design.clone(), checks: self };
        sealed_json::write(&folder.join(CHECKS_FILE), &kept)
    }
}
