//! A solved ray: the converged increments of one window, with their provenance.

use crate::{FailureKind, Solved, ToolVersions, WindowProblem};
use hinge::{HingeDesign, HingeSample};
use mesher::Tier;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;
use support::Fault;

/// A ray that was solved: the converged increments of one window, which give samples of
/// (eps, g) -> (W, grad W, D), section 2.4, and where they are from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolvedRay {
    /// Id of its job (one geometry, one end).
    pub job: String,
    /// The hinge design.
    pub design: HingeDesign,
    /// Deformation, energy, forces and damage of its increments.
    pub samples: Vec<HingeSample>,
    /// Why it stopped before its end; `None` for a complete ray.
    pub failure: Option<FailureKind>,
    /// Name of the sheet material.
    pub material: String,
    /// [`hinge::SheetMaterial::law_hash`] of the material; empty if unknown.
    pub material_hash: String,
    /// Hash of the settings that all jobs of a campaign share, except the material; empty if
    /// unknown.
    pub settings_hash: String,
    /// Requested mesh, or the mesh that the samples were corrected to.
    pub tier: Fidelity,
    /// Mesh on which it was solved: a finer one if the requested mesh failed.
    pub solved_tier: Tier,
    /// Versions of the programs that solved it.
    pub tools: ToolVersions,
    /// CPU time (s).
    pub cpu_s: f64,
}

impl SolvedRay {
    /// The ray of a solved window with these samples.
    pub fn new(window: &Solved, samples: Vec<HingeSample>) -> Self {
        let Solved { id, solve, record, .. } = window;
        let WindowProblem { hinge, material, tier, .. } = &solve.problem;
        Self {
            job: id.clone(),
            design: hinge.design,
            samples,
            failure: record.failure,
            material: material.name.clone(),
            material_hash: material.law_hash(),
            settings_hash: solve.settings_hash(),
            tier: Fidelity::Solved(*tier),
            solved_tier: record.tier,
            tools: solve.tools.clone(),
            cpu_s: record.cpu_seconds,
        }
    }

    /// Whether it was solved on the tier of its campaign, and not on a finer one after a failure.
    pub fn at_requested_tier(&self) -> bool {
        self.tier == Fidelity::Solved(self.solved_tier)
    }
}

/// The meshes of the rays of a database. Files state its text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum Fidelity {
    /// Solved on this mesh.
    Solved(Tier),
    /// Solved on one mesh and corrected to a finer one.
    Corrected {
        /// The mesh on which they were solved.
        from: Tier,
        /// The finer mesh.
        to: Tier,
    },
}

/// Separator of the two mesh names of corrected rays.
const CORRECTED_TO: &str = " corrected to ";

impl Fidelity {
    /// The mesh whose results the samples represent.
    pub fn mesh(self) -> Tier {
        match self {
            Self::Solved(mesh) | Self::Corrected { to: mesh, .. } => mesh,
        }
    }
}

impl Default for Fidelity {
    fn default() -> Self {
        Self::Solved(Tier::default())
    }
}

impl fmt::Display for Fidelity {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Solved(mesh) => mesh.fmt(f),
            Self::Corrected { from, to } => write!(f, "{from}{CORRECTED_TO}{to}"),
        }
    }
}

impl FromStr for Fidelity {
    type Err = Fault;

    fn from_str(text: &str) -> Result<Self, Fault> {
        Ok(match text.split_once(CORRECTED_TO) {
            Some((from, to)) => Self::Corrected { from: from.parse()?, to: to.parse()? },
            None => Self::Solved(text.parse()?),
        })
    }
}

impl TryFrom<String> for Fidelity {
    type Error = Fault;

    fn try_from(text: String) -> Result<Self, Fault> {
        text.parse()
    }
}

impl From<Fidelity> for String {
    fn from(fidelity: Fidelity) -> Self {
        fidelity.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fidelity_is_written_and_read() {
        let corrected = Fidelity::Corrected { from: Tier::Default, to: Tier::Reference };
        assert_eq!(corrected.to_string(), "default corrected to reference");
        assert_eq!(corrected.to_string().parse(), Ok(corrected));
        assert_eq!(corrected.mesh(), Tier::Reference);
        assert_eq!("fine".parse(), Ok(Fidelity::Solved(Tier::Fine)));
        for unclear in ["default + tiny", "another solver", ""] {
            assert!(unclear.parse::<Fidelity>().is_err(), "{unclear}");
        }
    }
}
