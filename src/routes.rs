//! The routes that the hinges of a deployed sheet take, as windows to be solved.

use anyhow::{Context, Result, ensure};
use design::design_vector::DesignVector;
use design::gradient::{Deployment, Model};
use design::scene::Scene;
use fe_driver::{DeformationPath, KeptSolve, StepControl};
use hinge::{HingeDeformation, HingeDesign, SheetMaterial};
use mesher::Tier;
use std::path::PathBuf;
use surrogate::Surrogate;

/// What one hinge of a sheet does on the way to full load.
#[derive(Clone, Debug)]
pub struct HingeRoute {
    /// Number of the hinge, vertex by vertex and x before x'.
    pub hinge: usize,
    pub design: HingeDesign,
    /// One state a load step.
    pub states: Vec<HingeDeformation>,
}

/// The routes of every hinge of a design.
pub fn hinge_routes(scene: &Scene, design: &DesignVector) -> Result<Vec<HingeRoute>> {
    let problem = scene.problem()?;
    ensure!(
        matches!(problem.model, Model::Equilibrium(_)),
        "the scene has no hinge law that could say where its hinges go (hinge = \"pin\")"
    );
    let deployment = problem.deploy(design)?;
    deployment.at_full_load()?;
    let Deployment { sheet, path, .. } = deployment;
    let designs = sheet.designs().into_iter().enumerate();
    let routes = designs.map(|(hinge, design)| HingeRoute {
        hinge,
        design,
        states: path.iter().map(|step| step.deformations[hinge]).collect(),
    });
    Ok(routes.collect())
}

/// Further networks that were trained on the data of `surrogate`, whose spread estimates its error.
pub fn ensemble(surrogate: &Surrogate, files: &[PathBuf]) -> Result<Vec<Surrogate>> {
    let load = |path: &PathBuf| {
        let network = Surrogate::load(path)?;
        let (own, other) = (surrogate.card(), network.card());
        ensure!(
            own.dataset_hash == other.dataset_hash && own.split_hash == other.split_hash,
            "{} was not trained on the data of the scene's weights: no ensemble with them",
            path.display()
        );
        Ok(network)
    };
    files.iter().map(load).collect()
}

/// The mesh that weights speak for: that of the database they were trained on, or the finer one it was
/// corrected to; the default one if their card knows none of ours.
pub fn tier_of(surrogate: &Surrogate) -> Tier {
    judging_tier(&surrogate.card().tier)
}

fn judging_tier(told: &str) -> Tier {
    dataset::speaks_for(told).parse().unwrap_or_default()
}

/// The window of a hinge that follows a path, with the step control of a campaign.
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
    /// The last state.
    pub fn end(&self) -> HingeDeformation {
        self.states.last().copied().unwrap_or_default()
    }

    /// The window that follows the route.
    pub fn recorded(&self, material: &SheetMaterial, tier: Tier) -> Result<KeptSolve> {
        let path = DeformationPath::through(&self.states)
            .with_context(|| format!("hinge {} has no states", self.hinge))?;
        Ok(window(self.design, path, material, tier))
    }

    /// The window that goes straight to the same end.
    pub fn straight(&self, material: &SheetMaterial, tier: Tier) -> KeptSolve {
        window(
            self.design,
            DeformationPath::straight(self.end()),
            material,
            tier,
        )
    }

    /// Greatest distance between the route and the straight ray to its end, at equal fractions of
    /// the journey, in ligament widths.
    ///
    /// Distances are those of (eta_a, eta_s, theta): a turn by one radian moves what is a ligament
    /// width from O by a ligament width.
    pub fn separation(&self) -> f64 {
        let w_lig = self.design.w_lig;
        let place = |state: &HingeDeformation| {
            let [eta_a, eta_s] = state.eta(w_lig);
            [eta_a, eta_s, state.theta]
        };
        let mut places = vec![[0.0; 3]];
        places.extend(self.states.iter().map(place));
        let mut journey = vec![0.0];
        for pair in places.windows(2) {
            journey.push(journey[journey.len() - 1] + distance(pair[0], pair[1]));
        }
        let whole = journey[journey.len() - 1].max(f64::MIN_POSITIVE);
        let end = places[places.len() - 1];
        let gaps = places.iter().zip(&journey).map(|(place, gone)| {
            let on_the_ray = end.map(|x| gone / whole * x);
            distance(*place, on_the_ray)
        });
        gaps.fold(0.0, f64::max)
    }
}

fn distance(x: [f64; 3], y: [f64; 3]) -> f64 {
    let squares = std::iter::zip(x, y).map(|(x, y)| (x - y).powi(2));
    squares.sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn route(states: &[[f64; 3]]) -> HingeRoute {
        HingeRoute {
            hinge: 0,
            design: HingeDesign {
                w_lig: 10.0,
                alpha: 1.5,
                fillet_ratio: 0.16,
                kerf: 0.2,
                r_win: 100.0,
            },
            states: states.iter().map(|state| (*state).into()).collect(),
        }
    }

    #[test]
    fn weights_are_judged_by_the_mesh_they_speak_for() {
        assert_eq!(judging_tier("tiny"), Tier::Tiny);
        assert_eq!(
            judging_tier("default corrected to reference"),
            Tier::Reference
        );
        for unclear in ["default + tiny", "another solver", ""] {
            assert_eq!(judging_tier(unclear), Tier::Default);
        }
    }

    #[test]
    fn a_straight_route_is_its_ray_whatever_its_pace() {
        let route = route(&[[0.1, 0.2, 0.05], [0.2, 0.4, 0.1], [2.0, 4.0, 1.0]]);
        assert!(route.separation() < 1e-15);
    }

    #[test]
    fn a_right_angle_is_separated_at_its_corner() {
        // Turn by 0.3, then 0.4 ligament widths: the corner is 3/7 along, 0.24 from the ray there.
        let route = route(&[[0.0, 0.0, 0.3], [4.0, 0.0, 0.3]]);
        let share = 3.0 / 7.0;
        let gap = distance([0.0, 0.0, 0.3], [share * 0.4, 0.0, share * 0.3]);
        assert!((route.separation() - gap).abs() < 1e-15);
        assert_eq!(route.end().to_array(), [4.0, 0.0, 0.3]);
    }
}
