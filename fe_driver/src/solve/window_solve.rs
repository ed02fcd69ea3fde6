//! The identity of a window solve.

use crate::record_file::short_hash;
use crate::solve::hinge_path::HingePath;
use crate::solve::step_control::StepControl;
use crate::solve::tool_versions::ToolVersions;
use hinge::SheetMaterial;
use mesher::{MeshRecipe, Tier};
use serde::{Deserialize, Serialize};

/// Version of the geometry, the input deck and the evaluation. It is increased when a change of the code changes
/// results; solves of an older version are then stale.
///
/// 2: D_peak is the mean over the most strained 1 % of the ligament.
const RECIPE_VERSION: u32 = 2;

/// A window problem, without what solves it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WindowProblem {
    /// The design and its path.
    #[serde(rename = "ray")]
    pub hinge: HingePath,
    /// The sheet material.
    pub material: SheetMaterial,
    /// Mesh of the window.
    pub tier: Tier,
    /// The increments of the solve.
    pub step: StepControl,
}

/// All inputs of the result of a window solve. Its id is a hash of them: two solves of one id have the same result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WindowSolve {
    /// The window problem.
    pub problem: WindowProblem,
    /// The recipe of the mesh: that of the tier, except in studies of the mesh.
    pub mesh: MeshRecipe,
    /// Versions of the external programs.
    pub tools: ToolVersions,
    /// Version of the geometry, the input deck and the evaluation.
    pub recipe_version: u32,
}

impl WindowProblem {
    /// The problem with the usual increments.
    pub fn new(hinge: impl Into<HingePath>, material: &SheetMaterial, tier: Tier) -> Self {
        Self {
            hinge: hinge.into(),
            material: material.clone(),
            tier,
            step: StepControl::default(),
        }
    }
}

impl WindowSolve {
    /// The solve of a problem on the mesh of its tier.
    pub fn new(problem: WindowProblem, tools: &ToolVersions) -> Self {
        Self {
            mesh: problem.tier.recipe(),
            problem,
            tools: tools.clone(),
            recipe_version: RECIPE_VERSION,
        }
    }

    /// The id: 16 hexadecimal digits.
    pub fn id(&self) -> String {
        short_hash(self)
    }

    /// Hash of the settings that all solves of a campaign share, except the material: mesh, increments, programs.
    pub fn settings_hash(&self) -> String {
        let WindowProblem { tier, step, .. } = &self.problem;
        short_hash(&(tier, &self.mesh, step, &self.tools, self.recipe_version))
    }

    /// Names of the settings that differ from `other`; empty if only the hinge and its path differ.
    pub fn differences(&self, other: &Self) -> Vec<&'static str> {
        let (a, b) = (&self.problem, &other.problem);
        let settings = [
            ("material", a.material != b.material),
            ("mesh tier", a.tier != b.tier || self.mesh != other.mesh),
            ("step control", a.step != b.step),
            ("tool versions", self.tools != other.tools),
            (
                "recipe version",
                self.recipe_version != other.recipe_version,
            ),
        ];
        let different = settings.into_iter().filter(|(_, differs)| *differs);
        different.map(|(name, _)| name).collect()
    }
}
