//! The paths of the hinges of a deployed sheet, as windows to be solved.

use anyhow::{Context, Result, ensure};
use dataset::Fidelity;
use design::analysis::path_separation::PathSeparation;
use design::objective::design_problem::{Deployment, Model};
use design::pattern::design_vector::DesignVector;
use design::scene::Scene;
use fe_driver::{DeformationPath, KeptSolve, StepControl};
use hinge::{HingeDeformation, HingeDesign, SheetMaterial};
use mesher::Tier;
use std::path::PathBuf;
use surrogate::Surrogate;

/// The path of one hinge of a sheet, from the flat sheet to full load.
#[derive(Clone, Debug)]
pub struct HingeRoute {
    /// Number of the hinge: ordered by vertex, x before x'.
    pub hinge: usize,
    /// The hinge design.
    pub design: HingeDesign,
    /// One state per load step.
    pub states: Vec<HingeDeformation>,
}

/// The paths of all hinges of a design.
pub fn hinge_routes(scene: &Scene, design: &DesignVector) -> Result<Vec<HingeRoute>> {
    let problem = scene.problem()?;
    ensure!(
        matches!(problem.model, Model::Equilibrium(_)),
        "hinge paths need a hinge law with stiffness: the scene has hinge = \"pin\""
    );
    let deployment = problem.deploy(design)?;
    deployment.at_full_load()?;
    Ok(routes_of(&deployment))
}

/// The paths of all hinges of a deployed sheet.
pub fn routes_of(deployment: &Deployment) -> Vec<HingeRoute> {
    let Deployment { sheet, path, .. } = deployment;
    let designs = sheet.designs().into_iter().enumerate();
    let routes = designs.map(|(hinge, design)| HingeRoute {
        hinge,
        design,
        states: path.iter().map(|step| step.deformations[hinge]).collect(),
    });
    routes.collect()
}

/// The other networks of an ensemble with the scene's `surrogate`, whose spread estimates its error: `files`, trained on
/// the same data, or those that the scene names.
pub fn ensemble(scene: &Scene, surrogate: &Surrogate, files: &[PathBuf]) -> Result<Vec<Surrogate>> {
    if files.is_empty() {
        return Ok(scene.networks().iter().skip(1).cloned().collect());
    }
    let load = |path: &PathBuf| {
        let network = scene.network(path)?;
        let (own, other) = (surrogate.card(), network.card());
        ensure!(
            own.dataset_hash == other.dataset_hash && own.split_hash == other.split_hash,
            "{} was not trained on the data of the scene's weights and cannot be in an ensemble with them",
            path.display()
        );
        Ok(network)
    };
    files.iter().map(load).collect()
}

/// The mesh tier to test weights on: `requested`, or that of the database they were trained on, or the finer tier
/// that the database was corrected to.
pub fn judging_tier(requested: Option<Tier>, surrogate: &Surrogate) -> Result<Tier> {
    match requested {
        Some(tier) => Ok(tier),
        None => tier_of(&surrogate.card().tier),
    }
}

fn tier_of(trained_on: &str) -> Result<Tier> {
    let tier = Fidelity::from_tier(trained_on).mesh().parse();
    tier.with_context(|| {
        format!(
            "the weights were trained on the tier `{trained_on}`, which is no mesh tier: pass the \
             tier to compare with as --tier"
        )
    })
}

/// The window of a hinge along a path, with the step control of a campaign.
pub fn window(
    design: HingeDesign,
    path: DeformationPath,
    material: &SheetMaterial,
    tier: Tier,
) -> KeptSolve {
    KeptSolve {
        design,
        path,
        material: material.clone(),
        recipe: tier.recipe(),
        step: StepControl::default(),
    }
}

impl HingeRoute {
    /// The similar path of the hinge in a sheet of `factor` times the thickness.
    pub fn scaled(&self, factor: f64) -> Self {
        let states = self.states.iter();
        Self {
            hinge: self.hinge,
            design: self.design.scaled(factor),
            states: states.map(|state| state.scaled(factor)).collect(),
        }
    }

    /// The last state.
    pub fn end(&self) -> HingeDeformation {
        self.states.last().copied().unwrap_or_default()
    }

    /// The window solve along the recorded path.
    pub fn recorded(&self, material: &SheetMaterial, tier: Tier) -> Result<KeptSolve> {
        let path = DeformationPath::through(&self.states)
            .with_context(|| format!("hinge {} has no states", self.hinge))?;
        Ok(window(self.design, path, material, tier))
    }

    /// The window solve along the straight ray to the same end.
    pub fn straight(&self, material: &SheetMaterial, tier: Tier) -> KeptSolve {
        window(
            self.design,
            DeformationPath::straight(self.end()),
            material,
            tier,
        )
    }

    /// How far the path departs from the straight ray to its end.
    pub fn separation(&self) -> PathSeparation {
        PathSeparation::of(self.design.w_lig, &self.states)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_judged_by_the_mesh_they_were_trained_on() {
        assert_eq!(tier_of("tiny").unwrap(), Tier::Tiny);
        let corrected = tier_of("default corrected to reference");
        assert_eq!(corrected.unwrap(), Tier::Reference);
        for unclear in ["default + tiny", "another solver", ""] {
            let message = tier_of(unclear).unwrap_err().to_string();
            assert!(message.contains("--tier"), "{message}");
        }
    }
}
