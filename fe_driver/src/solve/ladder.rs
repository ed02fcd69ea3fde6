//! The ladder of attempts at a window solve: what is tried next after each kind of failure.

use crate::solve::failure::FailureKind;
use crate::solve::step_control::StepControl;
use crate::solve::window_solve::WindowSolve;
use serde::{Deserialize, Serialize};

/// The attempts in their order, each made after an earlier one has failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, strum::Display)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum AttemptKind {
    /// The solve as requested.
    Requested,
    /// Unchanged, because the solve did not cause the failure.
    Again,
    /// Shorter increments on the same mesh.
    ShorterIncrements,
    /// Shorter increments on the next finer mesh.
    FinerTier,
}

/// A path that diverges beyond this lambda is not solved on a finer mesh.
const LONG: f64 = 0.5;

impl AttemptKind {
    /// The attempt after this one at a solve that `failure` ended at `lambda`; `None` if there is none left.
    ///
    /// A solve with a mesh or increments of its own, as a study of them has, is never solved with others.
    pub fn next(self, failure: FailureKind, solve: &WindowSolve, lambda: f64) -> Option<Self> {
        let next = match (failure, self) {
            (FailureKind::InvalidInput, _) | (_, Self::FinerTier) => None,
            (FailureKind::MeshFailed, _) => Some(Self::FinerTier),
            (
                FailureKind::NotStarted | FailureKind::Killed | FailureKind::OutputTruncated,
                Self::Requested,
            ) => Some(Self::Again),
            (FailureKind::NotStarted, _) => None,
            (_, Self::Requested | Self::Again) => Some(Self::ShorterIncrements),
            // The usual cause is a snap of the ligament, which also occurs on a finer mesh.
            (FailureKind::Diverged, Self::ShorterIncrements) if lambda > LONG => None,
            // A finer mesh would take even longer.
            (FailureKind::TimedOut, Self::ShorterIncrements) => None,
            (_, Self::ShorterIncrements) => Some(Self::FinerTier),
        };
        next.filter(|next| match next {
            Self::Requested | Self::Again => true,
            Self::ShorterIncrements => is_usual(solve),
            Self::FinerTier => is_usual(solve) && solve.problem.tier.finer().is_some(),
        })
    }

    /// What is solved in this attempt at a solve.
    pub fn solve(self, requested: &WindowSolve) -> WindowSolve {
        let mut solve = requested.clone();
        if matches!(self, Self::ShorterIncrements | Self::FinerTier) {
            solve.problem.step = StepControl::patient();
        }
        if self == Self::FinerTier {
            let tier = requested.problem.tier;
            solve.problem.tier = tier.finer().unwrap_or(tier);
            solve.mesh = solve.problem.tier.recipe();
        }
        solve
    }
}

/// Whether a solve has the mesh of its tier and the usual increments.
fn is_usual(solve: &WindowSolve) -> bool {
    let problem = &solve.problem;
    solve.mesh == problem.tier.recipe() && problem.step == StepControl::default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::fake_solver::tests::solve_on;
    use mesher::Tier;
    use strum::VariantNames;

    #[test]
    fn every_retry_ladder_ends() {
        let next = |tier, lambda| {
            AttemptKind::ShorterIncrements.next(FailureKind::Diverged, &solve_on(tier), lambda)
        };
        assert_eq!(next(Tier::Reference, 0.0), None);
        assert_eq!(next(Tier::Default, 0.4), Some(AttemptKind::FinerTier));
        assert_eq!(next(Tier::Default, 0.6), None);
        for name in FailureKind::VARIANTS {
            let kind: FailureKind = name.parse().unwrap();
            assert_eq!(kind.to_string(), *name);
            let mut attempt = AttemptKind::Requested;
            let mut attempts = 1;
            while let Some(next) = attempt.next(kind, &solve_on(Tier::Default), 0.0) {
                assert_ne!(next, attempt);
                attempt = next;
                attempts += 1;
            }
            assert!(attempts <= 4, "{kind}: {attempts}");
        }
    }

    #[test]
    fn a_mesh_or_increments_of_a_study_are_not_replaced() {
        let mut meshed = solve_on(Tier::Default);
        meshed.mesh.layers = 3;
        let mut stepped = solve_on(Tier::Default);
        stepped.problem.step.greatest = 0.07;
        for solve in [meshed, stepped] {
            let next = |attempt: AttemptKind, failure| attempt.next(failure, &solve, 0.0);
            assert_eq!(next(AttemptKind::Requested, FailureKind::Diverged), None);
            let again = next(AttemptKind::Requested, FailureKind::Killed);
            assert_eq!(again, Some(AttemptKind::Again));
            assert_eq!(next(AttemptKind::Again, FailureKind::Killed), None);
        }
    }
}
