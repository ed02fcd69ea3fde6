//! A deployed sheet that is unloaded: its equilibrium without loads, with hinges that are elastic
//! about their residual deformations.

use design::hinge_law::{Order, PreparedLaw, Release, ReleasedLaw};
use design::objective::design_problem::{Deployment, DesignError, DesignProblem, converged};
use design::sheet::kinematics::corner_distances;
use hinge::HingeDeformation;
use scene::Scene;
use serde::Serialize;
use std::array::from_fn;
use support::statistics::rms_and_maximum;
use surrogate::Springback;

/// The residual opening of a sheet.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
    law: &Springback,
    deployment: &Deployment,
) -> Result<ResidualShape, String> {
    let outside = deployment.hinges_outside();
    if outside > 0 {
        return Err(format!(
            "{outside} hinges are outside the training domain at full load, where the law of released hinges is not known"
        ));
    }
    let shape = unloaded(scene, problem, law, deployment).map_err(|error| error.to_string())?;
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
    law: &Springback,
    deployment: &Deployment,
) -> Result<ResidualShape, DesignError> {
    let mechanics = problem.model.equilibrium().map_err(DesignError::from)?;
    let loaded = deployment.at_full_load()?;
    let (sheet, designs) = (&deployment.sheet, deployment.sheet.designs());
    let prepared = mechanics.law.prepare(&designs);
    let hinges =
        Release { law, scale: scene.scale() }.hinges(&*prepared, &designs, &loaded.deformations);
    let released = ReleasedLaw(&hinges);
    let hinged = mechanics.hinged(sheet, &released, false);
    let path = mechanics.solver.unload(hinged, loaded.configuration.clone())?;
    let free = converged(path.last().expect("a path has at least one step"))?;
    let moved = corner_distances(sheet, &loaded.configuration, &free.configuration);
    let rotations = std::iter::zip(&loaded.deformations, &free.deformations);
    Ok(ResidualShape {
        rotations: rotations.map(|(on, off)| [on.theta, off.theta]).collect(),
        corners: rms_and_maximum(moved),
        snaps: path.iter().any(|step| step.jumps > 0),
    })
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
    let over: Vec<HingeDeformation> = std::iter::zip(&before.deformations, &last.deformations)
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
        let hinges = std::iter::zip(&energies, &last.deformations);
        hinges.map(|(energy, state)| energy.forces[2] * state.theta).sum()
    };
    let fraction = holds(&ReleasedLaw(&hinges)) / holds(&*prepared);
    fraction.is_finite().then_some(fraction)
}
