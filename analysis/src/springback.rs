//! A deployed sheet that is unloaded: its equilibrium without loads, with hinges that are elastic
//! about their residual deformations.

use design::equilibrium::load_step::LoadStep;
use design::hinge_law::{Order, PreparedLaw, Release, ReleasedLaw};
use design::objective::design_problem::{
    Deployment, DesignError, DesignProblem, Mechanics, converged,
};
use design::sheet::kinematics::corner_distances;
use faer::{Mat, Side, linalg::solvers::Solve};
use hinge::{HingeDeformation, ReleasedHinge};
use scene::Scene;
use serde::Serialize;
use std::{array::from_fn, iter::zip};
use support::{fault, statistics::rms_and_maximum};
use surrogate::Springback;

/// The residual opening of a sheet.
#[derive(Debug, Serialize)]
pub struct ResidualShape {
    /// Rotation of every hinge under load and without (rad).
    pub rotations: Vec<[f64; 2]>,
    /// Movement of the panel corners: root mean square and maximum (mm).
    pub corners: [f64; 2],
    /// Whether the sheet snaps to another state while the loads are taken off.
    pub snaps: bool,
}

impl ResidualShape {
    /// Mean rotation of the hinges under load and without (rad).
    pub fn mean_rotations(&self) -> [f64; 2] {
        let count = self.rotations.len() as f64;
        [0, 1].map(|i| self.rotations.iter().map(|pair| pair[i].abs()).sum::<f64>() / count)
    }

    /// Mean rotation without load over that under load; `None` if the hinges have not opened.
    pub fn fraction(&self) -> Option<f64> {
        let [loaded, free] = self.mean_rotations();
        (loaded > 0.0).then(|| free / loaded)
    }
}

/// The residual opening of a deployed sheet of a scene and its problem when it is unloaded, where
/// the law of unloaded hinges is known to hold.
///
/// # Errors
/// If hinges are outside the training domain at full load, if the sheet has no equilibrium with or
/// without loads, or if it would open further without them.
pub fn unload(
    scene: &Scene,
    problem: &DesignProblem,
    deployment: &Deployment,
) -> Result<ResidualShape, String> {
    let outside = deployment.hinges_outside();
    if outside > 0 {
        return Err(format!(
            "{outside} hinges are outside the training domain at full load, where the law of released hinges is not known"
        ));
    }
    let shape = unloaded(scene, problem, deployment).map_err(|error| error.to_string())?;
    let [loaded, free] = shape.mean_rotations().map(f64::to_degrees);
    if free > loaded {
        return Err(format!(
            "without its loads the sheet would open further, from {loaded:.1} to {free:.1} deg: the law of released hinges does not hold here"
        ));
    }
    Ok(shape)
}

/// The residual opening of a sheet whose hinges are inside the training domain.
fn unloaded(
    scene: &Scene,
    problem: &DesignProblem,
    deployment: &Deployment,
) -> Result<ResidualShape, DesignError> {
    let mechanics = problem.model.equilibrium().map_err(DesignError::from)?;
    let loaded = deployment.at_full_load()?;
    let released_sheet = ReleasedSheet::new(scene, mechanics, deployment)?;
    let free = converged(released_sheet.end())?;
    let moved = corner_distances(&deployment.sheet, &loaded.configuration, &free.configuration);
    let rotations = zip(&loaded.deformations, &free.deformations);
    Ok(ResidualShape {
        rotations: rotations.map(|(on, off)| [on.theta, off.theta]).collect(),
        corners: rms_and_maximum(moved),
        snaps: released_sheet.path.iter().any(|step| step.jumps > 0),
    })
}

/// A sheet that was opened and released.
pub(crate) struct ReleasedSheet {
    /// Its hinges.
    pub hinges: Vec<ReleasedHinge>,
    /// Its path while the loads are taken off.
    path: Vec<LoadStep>,
}

impl ReleasedSheet {
    /// A deployed sheet that is released, by the law of released hinges of its scene; without one
    /// its hinges are as stiff on the way back as flat ones.
    pub(crate) fn new(
        scene: &Scene,
        mechanics: &Mechanics,
        deployment: &Deployment,
    ) -> Result<Self, DesignError> {
        let designs = deployment.sheet.designs();
        let loaded = deployment.at_full_load()?;
        let (prepared, reached) = (mechanics.law.prepare(&designs), &loaded.deformations);
        let hinges = match &scene.springback {
            Some(law) => {
                Release { law, scale: scene.scale() }.hinges(&*prepared, &designs, reached)
            }
            None => elastic(&*prepared, reached)
                .ok_or_else(|| fault!("flat hinges are not stable by their law"))?,
        };
        let released = ReleasedLaw(&hinges);
        let hinged = mechanics.hinged(&deployment.sheet, &released, false);
        let path = mechanics.solver.unload(hinged, loaded.configuration.clone())?;
        Ok(Self { hinges, path })
    }

    /// The sheet without loads, if the step has converged.
    pub(crate) fn end(&self) -> &LoadStep {
        self.path.last().expect("a path has at least one step")
    }
}

/// The hinges that reached some states of a law, as stiff as flat ones: r = x - K^-1 f. `None` if
/// flat ones are not stable.
fn elastic(law: &dyn PreparedLaw, reached: &[HingeDeformation]) -> Option<Vec<ReleasedHinge>> {
    let flat = law.energies(&vec![HingeDeformation::default(); reached.len()], Order::Design);
    let energies = law.energies(reached, Order::Forces);
    let hinges = zip(reached, energies).zip(flat).map(|((at, energy), flat)| {
        let stiffness = flat.tangent;
        let factor = Mat::from_fn(3, 3, |i, j| stiffness[i][j]).llt(Side::Lower).ok()?;
        let sprung = factor.solve(Mat::from_fn(3, 1, |i, _| energy.forces[i]));
        let at = at.to_array();
        let rest: [f64; 3] = from_fn(|i| at[i] - sprung[(i, 0)]);
        Some(ReleasedHinge { rest: rest.into(), stiffness })
    });
    hinges.collect()
}

/// Over-opening by a person, as a fraction of the opening.
pub const TOO_FAR: f64 = 0.15;

/// The work rate M theta of the hinges of a sheet that was opened [too far](TOO_FAR) and brought
/// back, over the work rate of a sheet that was not: how firmly it holds. `None` if a hinge leaves
/// the training domain on the way, or if the sheet does not open at its last load step.
pub fn moment_after_overshoot(
    scene: &Scene,
    problem: &DesignProblem,
    law: &Springback,
    deployment: &Deployment,
) -> Option<f64> {
    let mechanics = problem.model.mechanics()?;
    let designs = deployment.sheet.designs();
    let prepared = mechanics.law.prepare(&designs);
    let loaded = &deployment.path[deployment.weight_steps().len()..];
    let [.., before, last] = loaded else {
        return None;
    };
    // Straight on from the last load step.
    let opens = last.mean_opening() - before.mean_opening();
    if opens <= 0.0 {
        return None;
    }
    let steps = TOO_FAR * last.mean_opening() / opens;
    let over: Vec<HingeDeformation> = zip(&before.deformations, &last.deformations)
        .map(|(before, last)| {
            let (before, last) = (before.to_array(), last.to_array());
            HingeDeformation::from(from_fn(|i| last[i] + steps * (last[i] - before[i])))
        })
        .collect();
    if prepared.inside(&over).contains(&false) {
        return None;
    }
    let hinges = Release { law, scale: scene.scale() }.hinges(&*prepared, &designs, &over);
    let holds = |law: &dyn PreparedLaw| -> f64 {
        let energies = law.energies(&last.deformations, Order::Forces);
        let hinges = zip(&energies, &last.deformations);
        hinges.map(|(energy, state)| energy.forces[2] * state.theta).sum()
    };
    let fraction = holds(&ReleasedLaw(&hinges)) / holds(&*prepared);
    fraction.is_finite().then_some(fraction)
}
