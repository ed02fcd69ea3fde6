//! The equilibrium of a sheet with finite elements for its hinges.
//!
//! Every hinge is solved along its path in the sheet. The hinge law is corrected to the forces of the finite elements at
//! full load, of this round and of those before ([`CorrectedLaw`]), and the sheet is deployed again; hinges then have other
//! states, and this is repeated until the panels stay where they are. It is a quasi-Newton iteration for the equilibrium of
//! the finite-element hinges: the tangent is that of the hinge law in the first round, and learns from each further one.

use crate::replays::kept_solves::SolveArgs;
use crate::replays::routes::routes_of;
use anyhow::{Result, bail, ensure};
use design::hinge_law::{CorrectedLaw, Correction, HingeLaw, MissingForces, Order};
use design::objective::design_problem::{Deployment, DesignProblem, Model};
use design::pattern::design_vector::DesignVector;
use design::scene::Scene;
use design::sheet::kinematics::deployed_corners;
use fe_driver::{KeptSolution, KeptSolve};
use hinge::HingeSample;
use mesher::Tier;
use serde::Serialize;
use std::path::Path;
use std::sync::Arc;

/// Largest movement of a panel corner in a round, relative to the size of the deployed sheet, at which the iteration
/// ends: a tenth of a millimetre in a metre.
pub const BALANCED: f64 = 1e-4;

/// One round: the hinges are solved, and the sheet is deployed with their forces.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Round {
    /// Root mean square difference of (F_a, F_s, M_theta / w_lig) of all hinges between finite elements and corrected
    /// law, relative to the root mean square of the former.
    pub force_error: f64,
    /// Largest movement of a panel corner (mm).
    pub movement: f64,
}

/// A sheet in equilibrium with the forces of finite elements.
pub struct Balanced {
    /// By the hinge law alone, followed by the deployment with the corrected law of each round.
    deployments: Vec<Deployment>,
    /// The last state of each hinge by finite elements.
    pub hinges: Vec<HingeSample>,
    /// All rounds in their order.
    pub rounds: Vec<Round>,
    /// CPU time of all window solves (s), if the operating system reports it.
    pub cpu_seconds: Option<f64>,
    /// Why no further round was made.
    pub ended: BalanceEnd,
}

/// Why the rounds ended.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum BalanceEnd {
    /// The last round moved the panels by less than [`BALANCED`]. Forces at the new states are not solved; the force error of
    /// the round is that of the states before.
    Converged,
    /// All rounds were made, and the panels still move.
    RoundsMade,
    /// A round after the first failed. The results are those of the rounds before.
    Failed(String),
}

impl BalanceEnd {
    /// What a person should know if the sheet is not balanced, with what to do.
    pub fn warning(&self) -> Option<String> {
        match self {
            Self::Converged => None,
            Self::RoundsMade => Some("the panels still move: use more --rounds".into()),
            Self::Failed(reason) => Some(format!("a further round failed: {reason}")),
        }
    }
}

/// Why a round failed.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
struct RoundFailed(String);

/// A round that was made.
struct Made {
    round: Round,
    hinges: Vec<HingeSample>,
    cpu_seconds: Option<f64>,
    /// The sheet by the corrected law.
    deployed: Deployment,
}

/// Windows and their limits.
pub struct WindowSolves<'a> {
    /// Tier of the meshes.
    pub tier: Tier,
    /// Number of parallel solves, and their time limit.
    pub args: &'a SolveArgs,
    /// Folder in which solutions are kept.
    pub folder: &'a Path,
}

/// Deploys a design with finite elements for its hinges, in at most `rounds` rounds. Also returns the problem of the
/// scene with the hinge law corrected to the finite elements of all rounds.
pub fn balanced(
    scene: &Scene,
    design: &DesignVector,
    windows: &WindowSolves,
    rounds: usize,
) -> Result<(Balanced, DesignProblem)> {
    ensure!(rounds > 0, "at least one round is needed");
    let mut problem = scene.problem()?;
    let law = law_of(&mut problem)?.clone();
    let deployed = problem.deploy(design)?;
    deployed.at_full_load()?;
    let mut missing = vec![Vec::new(); deployed.sheet.designs().len()];
    let mut found = Balanced {
        deployments: vec![deployed],
        hinges: Vec::new(),
        rounds: Vec::new(),
        cpu_seconds: Some(0.0),
        ended: BalanceEnd::RoundsMade,
    };
    while found.rounds.len() < rounds && found.ended != BalanceEnd::Converged {
        let made = match round(
            scene,
            design,
            windows,
            &law,
            &mut missing,
            &mut problem,
            found.by_elements(),
        ) {
            Ok(made) => made,
            Err(error) if error.is::<RoundFailed>() && !found.rounds.is_empty() => {
                found.ended = BalanceEnd::Failed(error.to_string());
                break;
            }
            Err(error) => return Err(error),
        };
        if made.round.movement <= BALANCED * size(&made.deployed) {
            found.ended = BalanceEnd::Converged;
        }
        found.deployments.push(made.deployed);
        found.hinges = made.hinges;
        found.rounds.push(made.round);
        let spent = found.cpu_seconds.zip(made.cpu_seconds);
        found.cpu_seconds = spent.map(|(before, now)| before + now);
    }
    Ok((found, problem))
}

/// Solves the hinges along their paths in `deployed`, the sheet of `problem`, adds to `missing`, for each hinge, what the
/// law lacks of their forces, and deploys the sheet with the law corrected to them, which `problem` then has. After a
/// [`RoundFailed`] it has the law that it had before.
fn round(
    scene: &Scene,
    design: &DesignVector,
    windows: &WindowSolves,
    law: &Arc<dyn HingeLaw>,
    missing: &mut [Vec<MissingForces>],
    problem: &mut DesignProblem,
    deployed: &Deployment,
) -> Result<Made> {
    let solutions = solved(scene, deployed, windows)?;
    let cpu_seconds = (solutions.iter())
        .map(|(solution, _)| solution.cpu_seconds)
        .sum();
    let hinges: Vec<HingeSample> = solutions.into_iter().map(|(_, end)| end).collect();
    let force_error = force_error(&problem.model, deployed, &hinges);
    let designs = deployed.sheet.designs();
    let now = missing_forces(law, deployed, &hinges);
    for (known, now) in missing.iter_mut().zip(now) {
        known.push(now);
    }
    let corrections = (designs.iter().zip(&*missing))
        .map(|(design, missing)| Correction::new(design, missing))
        .collect();
    let corrected = Arc::new(CorrectedLaw::new(law.clone(), corrections));
    let before = std::mem::replace(law_of(problem)?, corrected);
    let next = problem.deploy(design)?;
    if let Err(error) = next.at_full_load() {
        *law_of(problem)? = before;
        bail!(RoundFailed(error.to_string()));
    }
    let movement = movements(deployed, &next).into_iter().fold(0.0, f64::max);
    Ok(Made {
        round: Round {
            force_error,
            movement,
        },
        hinges,
        cpu_seconds,
        deployed: next,
    })
}

/// The hinge law of a problem.
fn law_of(problem: &mut DesignProblem) -> Result<&mut Arc<dyn HingeLaw>> {
    match &mut problem.model {
        Model::Equilibrium(mechanics) => Ok(&mut mechanics.law),
        Model::Ideal { .. } => bail!("pin hinges have no forces to be balanced"),
    }
}

impl Balanced {
    /// The deployment by the hinge law alone.
    pub fn by_law(&self) -> &Deployment {
        &self.deployments[0]
    }

    /// The deployment with the corrected law of the last round.
    pub fn by_elements(&self) -> &Deployment {
        &self.deployments[self.deployments.len() - 1]
    }
}

/// The solution of each hinge along its path in the sheet, with its last state.
fn solved(
    scene: &Scene,
    deployment: &Deployment,
    windows: &WindowSolves,
) -> Result<Vec<(KeptSolution, HingeSample)>> {
    let routes = routes_of(deployment);
    let solves: Vec<KeptSolve> = routes
        .iter()
        .map(|route| route.recorded(&scene.material, windows.tier))
        .collect::<Result<_>>()?;
    let outcomes = windows
        .args
        .solve(&solves.iter().collect::<Vec<_>>(), windows.folder)?;
    let mut failures = Vec::new();
    let mut ends = Vec::new();
    for (hinge, outcome) in outcomes.into_iter().enumerate() {
        match outcome {
            Ok(solution) => match solution.samples.last().copied() {
                Some(end) => ends.push((solution, end)),
                None => failures.push(format!("hinge {hinge}: no increment")),
            },
            Err(reason) => failures.push(format!("hinge {hinge}: {reason}")),
        }
    }
    if failures.is_empty() {
        return Ok(ends);
    }
    bail!(RoundFailed(format!(
        "the equilibrium needs the forces of every hinge; not solved: {}. Try another mesh with --tier",
        failures.join("; ")
    )))
}

/// What the law lacks of the forces of finite elements at the last state of the path.
fn missing_forces(
    law: &Arc<dyn HingeLaw>,
    deployment: &Deployment,
    hinges: &[HingeSample],
) -> Vec<MissingForces> {
    let designs = deployment.sheet.designs();
    let states = &deployment.final_step().deformations;
    let own = law.prepare(&designs).energies(states, Order::Forces);
    let missing = (0..designs.len()).map(|h| {
        let measured = hinges[h].forces().to_array();
        MissingForces {
            state: states[h],
            forces: std::array::from_fn(|i| measured[i] - own[h].forces[i]),
        }
    });
    missing.collect()
}

/// See [`Round::force_error`].
fn force_error(model: &Model, deployment: &Deployment, hinges: &[HingeSample]) -> f64 {
    let Model::Equilibrium(mechanics) = model else {
        return 0.0;
    };
    let designs = deployment.sheet.designs();
    let states = &deployment.final_step().deformations;
    let prepared = mechanics.law.prepare(&designs);
    let own = prepared.energies(states, Order::Forces);
    let (mut errors, mut squares) = (0.0, 0.0);
    for (h, design) in designs.iter().enumerate() {
        let measured = hinges[h].forces().to_array();
        for (i, arm) in [1.0, 1.0, design.w_lig].into_iter().enumerate() {
            errors += ((measured[i] - own[h].forces[i]) / arm).powi(2);
            squares += (measured[i] / arm).powi(2);
        }
    }
    (errors / squares.max(f64::MIN_POSITIVE)).sqrt()
}

/// Distance of each panel corner between the last states of two deployments of one sheet (mm).
pub fn movements(from: &Deployment, to: &Deployment) -> Vec<f64> {
    let corners =
        |of: &Deployment| deployed_corners(&of.sheet, &of.final_step().configuration).concat();
    std::iter::zip(corners(from), corners(to))
        .map(|([x, y], [x2, y2])| f64::hypot(x2 - x, y2 - y))
        .collect()
}

/// Diagonal of the deployed sheet's bounding box (mm).
pub fn size(deployment: &Deployment) -> f64 {
    let corners =
        deployed_corners(&deployment.sheet, &deployment.final_step().configuration).concat();
    let extent = |i: usize| {
        let along = corners.iter().map(|corner| corner[i]);
        along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
    };
    f64::hypot(extent(0), extent(1))
}
