//! The equilibrium of a sheet with finite elements for its hinges.
//!
//! Every hinge is solved along its path in the sheet. The hinge law is corrected to the forces of
//! the finite elements at full load, of this round and, unless that makes too long a step, of the
//! rounds before ([`CorrectedLaw`]), and the sheet is deployed again; hinges then have other
//! states, and this is repeated until the panels stay where they are. It is a quasi-Newton
//! iteration for the equilibrium of the finite-element hinges: in the first round the tangent is
//! the tangent of the hinge law, and it learns from each further round. Windows of the finest mesh
//! are expensive: the sheet is balanced on a cheaper mesh first ([`Tier::draft`]), from which the
//! finest one begins, and the difference between both is the error of the cheaper mesh.

use crate::element_windows::{ElementWindows, UnsolvedHinge};
use crate::verification_error::VerificationError;
use analysis::error_budget::ErrorBudget;
use design::geometry::polygon::{bounds, distance};
use design::hinge_law::{CorrectedLaw, Correction, HingeLaw, MissingForces, Order};
use design::objective::design_problem::{Deployment, DesignError, DesignProblem, Model};
use design::pattern::design_vector::DesignVector;
use design::sheet::kinematics::{corner_distances, deployed_corners};
use hinge::HingeSample;
use mesher::Tier;
use scene::Scene;
use serde::Serialize;
use std::sync::Arc;
use support::{Extremes, ensure, refuse};

/// Largest movement of a panel corner in a round, relative to the size of the deployed sheet, at
/// which the iteration ends: a tenth of a millimetre in a metre.
pub const BALANCED: f64 = 1e-4;
/// Largest force error of a round at which the iteration ends: panels that hardly move do not show
/// that stiff hinges carry another load.
pub const BALANCED_FORCES: f64 = 0.02;

/// One round: the hinges are solved, and the sheet is deployed with their forces.
#[derive(Clone, Debug, Serialize)]
pub struct Round {
    /// Mesh tier of its windows.
    pub tier: Tier,
    /// Root mean square difference of (F_a, F_s, M_theta / w_lig) of the solved hinges between
    /// finite elements and corrected law, relative to the root mean square of the former.
    pub force_error: f64,
    /// Largest movement of a panel corner (mm).
    pub movement: f64,
    /// Hinges that were not solved: in this round the law stands for them, as corrected in the
    /// rounds before.
    pub unsolved: Vec<UnsolvedHinge>,
}

/// A sheet in equilibrium with the forces of finite elements.
pub struct Balanced {
    /// The deployment by the hinge law, followed by the deployment with the corrected law of each round.
    deployments: Vec<Deployment>,
    /// The last state of each hinge by finite elements, in the last round that solved it; `None` if
    /// no round did.
    pub hinges: Vec<Option<HingeSample>>,
    /// All rounds in their order.
    pub rounds: Vec<Round>,
    /// CPU time of all window solves (s).
    pub cpu_seconds: f64,
    /// Why no further round was made on the finest mesh.
    pub ended: BalanceEnd,
    /// The same on the cheaper mesh, if there was one.
    pub draft_ended: Option<BalanceEnd>,
}

/// Why the rounds ended.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum BalanceEnd {
    /// The last round moved the panels by less than [`BALANCED`], and its forces differed by less
    /// than [`BALANCED_FORCES`]. Forces at the new states are not solved; the force error of the
    /// round is the force error of the states before.
    Converged,
    /// All rounds were made, and the panels still move or the forces still differ.
    RoundsMade,
    /// A round after the first failed. The results come from the rounds before.
    Failed(String),
}

impl BalanceEnd {
    /// What a person should know if the sheet is not balanced, with what to do.
    pub fn warning(&self) -> Option<String> {
        match self {
            Self::Converged => None,
            Self::RoundsMade => {
                Some("the panels still move, or the forces still differ: use more --rounds".into())
            }
            Self::Failed(reason) => Some(format!("a further round failed: {reason}")),
        }
    }
}

/// Most rounds on the cheaper mesh, which takes a sixth of the time of the finest one.
pub(crate) const DRAFT_ROUNDS: usize = 6;

/// Deploys a design with finite elements for its hinges: on the cheaper mesh of [`Tier::draft`]
/// until it is balanced, then in at most `rounds` rounds on the mesh of the windows. Also returns
/// the problem of the scene with the hinge law corrected to the finite elements of all rounds.
///
/// A hinge that is not solved ends no round unless it is the only one: see [`Round::unsolved`].
pub fn balanced(
    scene: &Scene,
    design: &DesignVector,
    windows: &ElementWindows,
    rounds: usize,
) -> Result<(Balanced, DesignProblem), VerificationError> {
    let draft = windows.tier.draft().map(|tier| (tier, DRAFT_ROUNDS));
    let meshes: Vec<_> = draft.into_iter().chain([(windows.tier, rounds)]).collect();
    ensure!(rounds > 0, "at least one round is needed");
    let mut problem = scene.problem()?;
    let law = law_of(&mut problem)?.clone();
    let deployed = problem.deploy(design)?;
    deployed.at_full_load()?;
    let count = deployed.sheet.designs().len();
    let mut iteration = Iteration { scene, design, law, missing: vec![Vec::new(); count], problem };
    let mut found = Balanced {
        deployments: vec![deployed],
        hinges: vec![None; count],
        rounds: Vec::new(),
        cpu_seconds: 0.0,
        ended: BalanceEnd::RoundsMade,
        draft_ended: None,
    };
    for (i, &(tier, rounds)) in meshes.iter().enumerate() {
        let ended = std::mem::replace(&mut found.ended, BalanceEnd::RoundsMade);
        if i > 0 {
            found.draft_ended = Some(ended);
            iteration.start_from_corrected_law()?;
        }
        let windows = ElementWindows { tier, ..*windows };
        iteration.rounds(&windows, rounds, &mut found)?;
    }
    Ok((found, iteration.problem))
}

/// The quasi-Newton iteration between two rounds.
struct Iteration<'a> {
    scene: &'a Scene,
    design: &'a DesignVector,
    /// The law that is corrected: the law of the scene, or the law that was balanced on the cheaper
    /// mesh.
    law: Arc<dyn HingeLaw>,
    /// What it lacks of the forces of each hinge, round by round.
    missing: Vec<Vec<MissingForces>>,
    /// The problem with the corrected law of the last round.
    problem: DesignProblem,
}

impl Iteration<'_> {
    /// Takes the corrected law as the law that further rounds correct. Their finite elements have
    /// other forces in nearly the states of the rounds before: one correction that met both would
    /// have a slope that no hinge has.
    fn start_from_corrected_law(&mut self) -> Result<(), VerificationError> {
        self.law = law_of(&mut self.problem)?.clone();
        self.missing.iter_mut().for_each(Vec::clear);
        Ok(())
    }

    /// Rounds on one mesh until the sheet is balanced. A round after the very first that finds no
    /// solved hinge or no equilibrium ends them, and the results come from the rounds before; any
    /// other error is an error of the task.
    fn rounds(
        &mut self,
        windows: &ElementWindows,
        most: usize,
        found: &mut Balanced,
    ) -> Result<(), VerificationError> {
        for _ in 0..most {
            match self.round(windows, found) {
                Ok(()) if found.ended == BalanceEnd::Converged => break,
                Ok(()) => {}
                Err(
                    error @ (VerificationError::NoHinge(_)
                    | VerificationError::Design(DesignError::NoEquilibrium { .. })),
                ) if !found.rounds.is_empty() => {
                    found.ended = BalanceEnd::Failed(error.to_string());
                    break;
                }
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Solves the hinges along their paths in the last deployment, and deploys the sheet with the
    /// law corrected to them. After an error the problem has the law that it had before.
    fn round(
        &mut self,
        windows: &ElementWindows,
        found: &mut Balanced,
    ) -> Result<(), VerificationError> {
        let deployed = found.by_elements();
        let solved = windows.solve(deployed, &self.scene.material)?;
        let ends = solved.ends;
        let force_error = force_error(&self.problem.model, deployed, &ends);
        self.add_missing_forces(deployed, &ends);
        let last = found.rounds.last().filter(|round| round.tier == windows.tier);
        let last = last.map_or(f64::INFINITY, |round| round.movement);
        let (next, movement) = self.step(deployed, last)?;
        if movement <= BALANCED * size(&next) && force_error <= BALANCED_FORCES {
            found.ended = BalanceEnd::Converged;
        }
        for (known, end) in found.hinges.iter_mut().zip(ends) {
            *known = end.or(*known);
        }
        found.cpu_seconds += solved.cpu_seconds;
        found.deployments.push(next);
        found.rounds.push(Round {
            tier: windows.tier,
            force_error,
            movement,
            unsolved: solved.unsolved,
        });
        Ok(())
    }

    /// The sheet with the law corrected to the finite elements so far, and its largest movement
    /// (mm).
    ///
    /// The slopes between states that hardly differ are slopes of the noise of their forces, and
    /// may throw the sheet far away. A step longer than the `last` one is therefore compared with
    /// the step only by the newest forces, on the tangent of the law, and the shorter step is
    /// made; after a step by the newest forces the earlier forces are forgotten. After an error the
    /// problem has the law that it had before.
    fn step(
        &mut self,
        deployed: &Deployment,
        last: f64,
    ) -> Result<(Deployment, f64), VerificationError> {
        let before = law_of(&mut self.problem)?.clone();
        let secant = self.corrected(deployed, &self.missing.clone());
        let length = |step: &Result<(Deployment, f64), VerificationError>| {
            step.as_ref().map_or(f64::INFINITY, |(_, movement)| *movement)
        };
        if length(&secant) > last && self.missing.iter().any(|missing| missing.len() > 1) {
            let by_secant = law_of(&mut self.problem)?.clone();
            let newest = self.missing.iter();
            let newest: Vec<_> =
                newest.map(|missing| Vec::from_iter(missing.last().copied())).collect();
            let plain = self.corrected(deployed, &newest);
            if length(&plain) < length(&secant) {
                self.missing = newest;
                return plain;
            }
            *law_of(&mut self.problem)? = by_secant;
        }
        if secant.is_err() {
            *law_of(&mut self.problem)? = before;
        }
        secant
    }

    /// Deploys the sheet with the law corrected by the missing forces of each hinge.
    fn corrected(
        &mut self,
        deployed: &Deployment,
        missing: &[Vec<MissingForces>],
    ) -> Result<(Deployment, f64), VerificationError> {
        let designs = deployed.sheet.designs();
        let corrections = (designs.iter().zip(missing))
            .map(|(design, missing)| Correction::new(design, missing))
            .collect();
        *law_of(&mut self.problem)? = Arc::new(CorrectedLaw { law: self.law.clone(), corrections });
        let next = self.problem.deploy(self.design)?;
        next.at_full_load()?;
        let movement = movements(deployed, &next).into_iter().largest();
        Ok((next, movement))
    }

    /// Adds what the law lacks of the forces of finite elements at the last states of the solved
    /// hinges.
    fn add_missing_forces(&mut self, deployed: &Deployment, ends: &[Option<HingeSample>]) {
        let states = &deployed.final_step().deformations;
        let prepared = self.law.prepare(&deployed.sheet.designs());
        let own = prepared.energies(states, Order::Forces);
        for (h, end) in ends.iter().enumerate() {
            if let Some(end) = end {
                let measured = end.forces();
                self.missing[h].push(MissingForces {
                    state: states[h],
                    forces: std::array::from_fn(|i| measured[i] - own[h].forces[i]),
                });
            }
        }
    }
}

/// The hinge law of a problem.
fn law_of(problem: &mut DesignProblem) -> Result<&mut Arc<dyn HingeLaw>, VerificationError> {
    match &mut problem.model {
        Model::Equilibrium(mechanics) => Ok(&mut mechanics.law),
        Model::Ideal { .. } => {
            refuse!("hinge paths need a hinge law with stiffness: the scene has level = \"pin\"")
        }
    }
}

impl Balanced {
    /// The deployment by the hinge law.
    pub fn by_law(&self) -> &Deployment {
        &self.deployments[0]
    }

    /// The error budget of the deployment by the hinge law, before finite elements: see
    /// [`ErrorBudget::new`].
    pub fn budget(&self, scene: &Scene) -> Result<Option<ErrorBudget>, VerificationError> {
        let problem = scene.problem()?;
        Ok(ErrorBudget::new(scene, &problem, self.by_law(), None))
    }

    /// The deployment with the corrected law of the last round on each mesh that had one, the
    /// finest one last.
    pub fn by_mesh(&self) -> impl Iterator<Item = (Tier, &Deployment)> {
        let rounds = self.rounds.iter().zip(&self.deployments[1..]).enumerate();
        rounds.filter_map(|(i, (round, deployment))| {
            let next = self.rounds.get(i + 1).map(|next| next.tier);
            (next != Some(round.tier)).then_some((round.tier, deployment))
        })
    }

    /// The error of the cheaper mesh: its tier and deployment, and the tier and deployment of the
    /// finest mesh. `None` if there is one mesh, or if the sheet was not balanced on the cheaper
    /// mesh.
    pub fn mesh_error(&self) -> Option<[(Tier, &Deployment); 2]> {
        let meshes: Vec<_> = self.by_mesh().collect();
        match (&self.draft_ended, &meshes[..]) {
            (Some(BalanceEnd::Converged), &[draft, finest]) => Some([draft, finest]),
            _ => None,
        }
    }

    /// The deployment with the corrected law of the last round.
    pub fn by_elements(&self) -> &Deployment {
        &self.deployments[self.deployments.len() - 1]
    }
}

/// See [`Round::force_error`].
fn force_error(model: &Model, deployment: &Deployment, ends: &[Option<HingeSample>]) -> f64 {
    let Model::Equilibrium(mechanics) = model else {
        return 0.0;
    };
    let designs = deployment.sheet.designs();
    let states = &deployment.final_step().deformations;
    let prepared = mechanics.law.prepare(&designs);
    let own = prepared.energies(states, Order::Forces);
    let (mut errors, mut squares) = (0.0, 0.0);
    for (h, design) in designs.iter().enumerate() {
        let Some(end) = &ends[h] else {
            continue;
        };
        let measured = end.forces();
        for (i, arm) in [1.0, 1.0, design.w_lig].into_iter().enumerate() {
            errors += ((measured[i] - own[h].forces[i]) / arm).powi(2);
            squares += (measured[i] / arm).powi(2);
        }
    }
    (errors / squares.max(f64::MIN_POSITIVE)).sqrt()
}

/// Distance of each panel corner between the last states of two deployments of one sheet (mm).
pub fn movements(from: &Deployment, to: &Deployment) -> Vec<f64> {
    let [from_state, to_state] = [from, to].map(|of| &of.final_step().configuration);
    corner_distances(&from.sheet, from_state, to_state)
}

/// Diagonal of the deployed sheet's bounding box (mm).
pub fn size(deployment: &Deployment) -> f64 {
    let corners =
        deployed_corners(&deployment.sheet, &deployment.final_step().configuration).concat();
    let [low, high] = bounds(corners);
    distance(low, high)
}
