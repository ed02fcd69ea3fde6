//! A window solve: its identity, and its attempts.

use crate::{AttemptKind, FailureKind, HingePath, Solve, ToolVersions, short_hash};
use hinge::{HingeSample, Regime, SheetMaterial};
use mesher::{MeshRecipe, Tier};
use serde::{Deserialize, Serialize};

/// Version of the geometry, the input deck and the evaluation. It is increased when a change of the
/// code changes results; solves of an older version are then stale.
///
/// 2: D_peak is the mean over the most strained 1 % of the ligament.
const RECIPE_VERSION: u32 = 2;
/// The version for paths that turn back. 3: an increment ends at the turn.
const TURNING_VERSION: u32 = 3;

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

/// All inputs of the result of a window solve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WindowSolve {
    /// The window problem.
    pub problem: WindowProblem,
    /// The mesh recipe of the tier.
    pub mesh: MeshRecipe,
    /// Versions of the external programs.
    pub tools: ToolVersions,
    /// Version of the geometry, the input deck and the evaluation.
    pub recipe_version: u32,
}

impl WindowProblem {
    /// The problem with the usual increments.
    pub fn new(hinge: HingePath, material: &SheetMaterial, tier: Tier) -> Self {
        Self {
            hinge,
            material: material.as_solved(),
            tier,
            step: StepControl::usual(tier.regime()),
        }
    }
}

impl WindowSolve {
    /// The solve of a problem on the mesh of its tier.
    pub fn new(problem: WindowProblem, tools: &ToolVersions) -> Self {
        Self {
            mesh: problem.tier.recipe(),
            recipe_version: match problem.hinge.path.turn() {
                None => RECIPE_VERSION,
                Some(_) => TURNING_VERSION,
            },
            problem,
            tools: tools.clone(),
        }
    }

    /// Hash of the settings that all solves of a campaign share, except the material: mesh,
    /// increments, programs. A path that turns back has the same ones.
    pub fn settings_hash(&self) -> String {
        let problem = &self.problem;
        short_hash(&(problem.tier, &self.mesh, &problem.step, &self.tools, RECIPE_VERSION))
    }

    /// Names of the settings that differ from `other`; empty if only the hinge and its path differ.
    pub fn differences(&self, other: &Self) -> Vec<&'static str> {
        let (a, b) = (&self.problem, &other.problem);
        let settings = [
            ("material", a.material != b.material),
            ("mesh tier", a.tier != b.tier || self.mesh != other.mesh),
            ("step control", a.step != b.step),
            ("tool versions", self.tools != other.tools),
            ("recipe version", self.recipe_version != other.recipe_version),
        ];
        let different = settings.into_iter().filter(|(_, differs)| *differs);
        different.map(|(name, _)| name).collect()
    }

    /// Whether it has the mesh of its tier and the usual increments.
    fn is_usual(&self) -> bool {
        let problem = &self.problem;
        let usual = StepControl::usual(problem.tier.regime());
        self.mesh == problem.tier.recipe() && problem.step == usual
    }
}

/// A path that diverges beyond this lambda is not solved on a finer mesh.
const LONG: f64 = 0.5;

impl Solve for WindowSolve {
    type Samples = Vec<HingeSample>;

    fn tier(&self) -> Tier {
        self.problem.tier
    }

    fn description(&self) -> String {
        let HingePath { design, path } = &self.problem.hinge;
        let end = path.at(1.0);
        let [eta_a, eta_s] = end.eta(design.w_lig);
        format!(
            "w_lig {:.2} mm, alpha {:.1} deg, path to (eta_a, eta_s, theta) = ({eta_a:.3}, {eta_s:.3}, {:.2} deg)",
            design.w_lig,
            design.alpha.to_degrees(),
            end.theta.to_degrees(),
        )
    }

    /// A solve with a mesh or increments of its own, as a study of them has, is never solved with
    /// others.
    fn next_attempt(
        &self,
        attempt: AttemptKind,
        failure: FailureKind,
        lambda: f64,
    ) -> Option<AttemptKind> {
        use AttemptKind::{Dynamic, FinerTier, Requested, ShorterIncrements};
        let next = match (failure, attempt) {
            (_, FinerTier | Dynamic) => None,
            (FailureKind::MeshFailed, _) => Some(FinerTier),
            (FailureKind::Diverged | FailureKind::EnergyImbalance, Requested) => {
                Some(ShorterIncrements)
            }
            // The usual cause is a snap of the ligament, which also occurs on a finer mesh.
            (FailureKind::Diverged, ShorterIncrements) if lambda > LONG => None,
            (FailureKind::Diverged | FailureKind::EnergyImbalance, ShorterIncrements) => {
                Some(FinerTier)
            }
            _ => None,
        };
        let finer = || self.problem.tier.finer().is_some();
        next.filter(|next| self.is_usual() && (*next != FinerTier || finer()))
    }

    fn attempted(&self, attempt: AttemptKind) -> Self {
        let mut solve = self.clone();
        if matches!(attempt, AttemptKind::ShorterIncrements | AttemptKind::FinerTier) {
            solve.problem.step = StepControl::patient();
        }
        if attempt == AttemptKind::FinerTier {
            let tier = self.problem.tier;
            solve.problem.tier = tier.finer().unwrap_or(tier);
            solve.mesh = solve.problem.tier.recipe();
        }
        solve
    }
}

// Automatic increments of a solve.

/// Automatic increments of a static path; lambda runs from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepControl {
    /// First increment; small, because the sheet buckles immediately.
    pub initial: f64,
    /// Minimum increment.
    pub least: f64,
    /// Maximum increment; longer increments overshoot and are cut back.
    pub greatest: f64,
    /// Maximum number of increments.
    pub max_increments: u32,
    /// Maximum residual force, over the average force.
    pub residual: f64,
    /// Maximum displacement correction, over the displacement increment.
    pub correction: f64,
}

impl Default for StepControl {
    fn default() -> Self {
        Self {
            initial: 0.005,
            least: 1e-5,
            greatest: 0.035,
            max_increments: 400,
            residual: 0.02,
            correction: 0.05,
        }
    }
}

impl StepControl {
    /// The usual increments. A plate does not buckle: longer increments change its energy by 0.1 %,
    /// and a path has 22 of them instead of 33.
    pub fn usual(regime: Regime) -> Self {
        match regime {
            Regime::Film => Self::default(),
            Regime::Plate => Self { initial: 0.02, greatest: 0.05, ..Self::default() },
        }
    }

    /// Settings for a ray that stopped early: shorter increments, and more of them.
    pub fn patient() -> Self {
        Self { least: 1e-6, greatest: 0.02, max_increments: 1000, ..Self::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::tests::solve_on;
    use strum::VariantNames;

    #[test]
    fn the_attempts_of_every_solve_end() {
        let next = |tier, lambda| {
            let shorter = AttemptKind::ShorterIncrements;
            solve_on(tier).next_attempt(shorter, FailureKind::Diverged, lambda)
        };
        assert_eq!(next(Tier::Reference, 0.0), None);
        assert_eq!(next(Tier::Default, 0.4), Some(AttemptKind::FinerTier));
        assert_eq!(next(Tier::Default, 0.6), None);
        for name in FailureKind::VARIANTS {
            let kind: FailureKind = name.parse().unwrap();
            assert_eq!(kind.to_string(), *name);
            let mut attempt = AttemptKind::Requested;
            let mut attempts = 1;
            while let Some(next) = solve_on(Tier::Default).next_attempt(attempt, kind, 0.0) {
                assert_ne!(next, attempt);
                attempt = next;
                attempts += 1;
            }
            assert!(attempts <= 3, "{kind}: {attempts}");
        }
    }

    #[test]
    fn a_mesh_or_increments_of_a_study_are_not_replaced() {
        let mut meshed = solve_on(Tier::Default);
        meshed.mesh.layers = 3;
        let mut stepped = solve_on(Tier::Default);
        stepped.problem.step.greatest = 0.07;
        for solve in [meshed, stepped] {
            let next = |attempt, failure| solve.next_attempt(attempt, failure, 0.0);
            assert_eq!(next(AttemptKind::Requested, FailureKind::Diverged), None);
        }
    }
}
