//! The paths of the hinges of a deployed sheet, as window problems.

use crate::verification_error::VerificationError;
use design::objective::design_problem::{Deployment, Model};
use design::pattern::design_vector::DesignVector;
use fe_driver::{DeformationPath, HingePath, WindowProblem};
use hinge::{HingeDeformation, HingeDesign, SheetMaterial};
use mesher::Tier;
use scene::Scene;

/// The path of one hinge of a sheet, from the flat sheet to full load.
#[derive(Clone, Debug)]
pub struct RecordedPath {
    /// Number of the hinge: ordered by vertex, x before x'.
    pub hinge: usize,
    /// The hinge design.
    pub design: HingeDesign,
    /// One state per load step.
    pub states: Vec<HingeDeformation>,
}

/// The paths of all hinges of a design.
pub fn recorded_paths(
    scene: &Scene,
    design: &DesignVector,
) -> Result<Vec<RecordedPath>, VerificationError> {
    let problem = scene.problem()?;
    if !matches!(problem.model, Model::Equilibrium(_)) {
        return Err(VerificationError::NoStiffness);
    }
    let deployment = problem.deploy(design)?;
    deployment.at_full_load()?;
    Ok(paths_of(&deployment))
}

/// The paths of all hinges of a deployed sheet.
pub fn paths_of(deployment: &Deployment) -> Vec<RecordedPath> {
    let Deployment { sheet, path, .. } = deployment;
    let designs = sheet.designs().into_iter().enumerate();
    let paths = designs.map(|(hinge, design)| RecordedPath {
        hinge,
        design,
        states: path.iter().map(|step| step.deformations[hinge]).collect(),
    });
    paths.collect()
}

impl RecordedPath {
    /// The last state.
    pub fn end(&self) -> HingeDeformation {
        self.states.last().copied().unwrap_or_default()
    }

    /// The hinge driven along the path, its states equally spaced in lambda.
    pub fn hinge_path(&self) -> Result<HingePath, VerificationError> {
        let path = DeformationPath::through(&self.states);
        let path = path.ok_or(VerificationError::NoStates(self.hinge))?;
        let design = self.design;
        Ok(HingePath { design, path })
    }

    /// The window problem along the path.
    pub fn problem(
        &self,
        material: &SheetMaterial,
        tier: Tier,
    ) -> Result<WindowProblem, VerificationError> {
        Ok(WindowProblem::new(self.hinge_path()?, material, tier))
    }
}
