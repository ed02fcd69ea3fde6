//! The error budget of a deployed sheet: how far each cause of errors moves its panel corners and
//! changes its load.
//!
//! An error of the hinge forces moves the sheet to first order by [`ForceResponse`].
//! A cause gives the standard deviations of these forces, from what was measured:
//!
//! | cause | force errors | of the hinges | measured |
//! |---|---|---|---|
//! | network | deviations of the ensemble at the states of the sheet | as the networks have them | the ensemble of the scene |
//! | window mesh | errors of the weights relative to a finer mesh, over the force | alike in like states | spot check on the card |
//! | material law | in proportion to the force | common | the material file |
//! | imperfection | in proportion to the force | independent | docs/results/window, docs/results/plates |
//! | loading path | in proportion to the force and the separation from the ray | independent | docs/TRIED.md |
//! | kerf | of a ligament that is narrower and of a hole that is wider, each by half of its tolerance | common | the scene |
//! | thickness | by similarity, of its tolerance | common | the scene |
//! | tilt | none: heights of the corners, by the bumps of ligaments | | docs/results/flatness |
//!
//! Finite elements of all hinges of the sheet replace the first two and the loading path. What they
//! leave is the movement of the panels in their last round.
//!
//! What is not measured is unknown: the sum of the others is a lower bound.

use crate::actuation_curve::ActuationCurve;
pub use crate::error_causes::{Effect, ErrorCause};

use crate::error_causes::LoadedSheet;
use design::equilibrium::force_response::ForceResponse;
use design::hinge_law::Order;
use design::objective::design_problem::{Deployment, DesignProblem};
use scene::Scene;
use serde::{Deserialize, Serialize};
use strum::VariantArray;

/// Number of hinges above which no budget is made: it takes three solves a hinge and more.
const MOST_HINGES: usize = 2000;

/// One cause of errors.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Contribution {
    /// What causes the errors.
    pub cause: ErrorCause,
    /// Source of their size or, if that is unknown, the reason.
    pub source: String,
    /// `None` if it is unknown.
    pub effect: Option<Effect>,
}

/// The error budget of a deployed sheet.
#[derive(Clone, Debug, Serialize)]
pub struct ErrorBudget {
    /// All causes.
    pub contributions: Vec<Contribution>,
    /// The root of the sum of the squares of those that are known.
    pub total: Effect,
}

impl ErrorBudget {
    /// The budget of a deployed design of a scene with a learned hinge law; `None` for another law,
    /// if full load is not reached, if the tangent there is singular, or for more than 2000 hinges.
    /// `residual` is the largest movement of a panel corner in the last balance with finite
    /// elements (mm), if the design was balanced with them.
    pub fn new(
        scene: &Scene,
        problem: &DesignProblem,
        deployment: &Deployment,
        residual: Option<f64>,
    ) -> Option<Self> {
        let weights = scene.surrogate()?;
        let mechanics = problem.model.mechanics()?;
        let last = deployment.at_full_load().ok()?;
        let sheet = &deployment.sheet;
        if sheet.hinges.len() > MOST_HINGES {
            return None;
        }
        let designs = sheet.designs();
        let law = mechanics.law.prepare(&designs);
        let hinged = mechanics.hinged(sheet, &*law, false);
        let [_, load] = *ActuationCurve::new(mechanics, deployment)?.points.last()?;
        let deployed = LoadedSheet {
            weights,
            response: ForceResponse::new(&mechanics.solver, hinged, last)?,
            energies: law.energies(&last.deformations, Order::Design),
            scene,
            problem,
            deployment,
            designs,
            load,
            residual,
        };
        let mut contributions = Vec::new();
        for &cause in ErrorCause::VARIANTS {
            if residual.is_some() && cause.is_seen_by_elements() {
                continue;
            }
            let (source, effect) = match deployed.effect(cause) {
                None => continue,
                Some(Ok((effect, source))) => (source, Some(effect?)),
                Some(Err(reason)) => (reason, None),
            };
            contributions.push(Contribution { cause, source, effect });
        }
        let total = Effect::new(vec![0.0; 4 * sheet.panels.len()], None);
        let mut budget = Self { contributions, total };
        budget.total = budget.sum(|_| true);
        Some(budget)
    }

    /// The root of the sum of the squares of the contributions whose causes `count`; a lower bound
    /// if one is unknown.
    pub fn sum(&self, count: impl Fn(ErrorCause) -> bool) -> Effect {
        let counted = || self.contributions.iter().filter(|part| count(part.cause));
        let none = Effect::new(vec![0.0; self.total.by_corner.len()], None);
        Effect {
            at_least: counted().any(|part| part.effect.is_none()),
            ..counted().filter_map(|part| part.effect.as_ref()).fold(none, Effect::with)
        }
    }
}
