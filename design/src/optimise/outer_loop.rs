//! The outer loop, Algorithm 1: Adam, L-BFGS or Gauss-Newton on theta = (z, ell, omega).
//!
//! Every few steps the path of the design is followed from the flat sheet; those between are corrected from that path.
//!
//! If the sheet of a design has no equilibrium, the step from the last design that had one is halved until
//! an equilibrium exists. Steps depend only on the problem and the search state, so a search continued from
//! a saved state follows the trajectory of an uninterrupted one.

use crate::equilibrium::nearby_path::KnownPath;
use crate::objective::design_problem::{DesignProblem, Evaluation, Model};
use crate::objective::scores::Scores;
use crate::optimise::backing_off::{MAX_HALVINGS, Setback, evaluate_or_back_off};
use crate::optimise::gauss_newton::ShapeCurvature;
use crate::optimise::search::{Search, SearchMethod};
use crate::pattern::design_vector::DesignVector;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicBool, Ordering};

/// The result of one step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepRecord {
    /// 0 is the start.
    pub step: usize,
    /// The objective and its terms.
    #[serde(flatten)]
    pub scores: Scores,
    /// Whether the path was followed from the flat sheet; `false` if it was corrected from that of an earlier design.
    #[serde(default)]
    pub followed: bool,
    /// Number of halvings, including those of a step that was given up.
    pub halvings: u32,
    /// Why the first design of the step without objective value had none; `None` if all had one.
    pub setback: Option<String>,
}

/// Why a run ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ended {
    /// All steps were made.
    Completed,
    /// Stopped on request; the next run continues.
    Stopped,
    /// No step from the last design lowers the loss by more than rounding: a minimum, or a kink that L-BFGS cannot leave.
    Settled,
    /// No step from the last design, however small, leads to a design with an equilibrium.
    Stuck {
        /// Why the last design that was tried has no objective value.
        reason: String,
    },
}

/// Everything that the next step depends on, besides the problem.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SearchState {
    /// The last design that was evaluated.
    pub(crate) design: DesignVector,
    /// The next design that the search evaluates.
    pub(crate) proposal: DesignVector,
    pub(crate) search: Search,
    /// The design with the minimum loss.
    pub best: DesignVector,
    /// The last design whose path was followed from the flat sheet; absent in states of older versions.
    #[serde(default)]
    anchor: Option<DesignVector>,
    /// The path of the anchor, if it is needed.
    #[serde(skip)]
    known: Option<KnownPath>,
    /// One record per step, beginning with that of the start.
    pub history: Vec<StepRecord>,
}

/// Continues the search from `state` until it has made `steps` steps after the start, until no step lowers
/// the loss, or until the end of the step during which `stop` becomes true.
///
/// `sink` receives the state after every step and may end the search by an error.
pub fn optimise<E>(
    problem: &DesignProblem,
    state: &mut SearchState,
    steps: usize,
    stop: &AtomicBool,
    sink: &mut dyn FnMut(&SearchState) -> Result<(), E>,
) -> Result<Ended, E> {
    loop {
        if state.history.len() > steps {
            return Ok(Ended::Completed);
        }
        if stop.load(Ordering::Relaxed) {
            return Ok(Ended::Stopped);
        }
        match state.next(problem) {
            Ok((design, evaluation, setback)) => {
                state.accept(problem, design, &evaluation, setback);
                sink(state)?;
            }
            Err(ended) => return Ok(ended),
        }
    }
}

impl SearchState {
    /// A search that has evaluated its start only.
    pub fn new(
        problem: &DesignProblem,
        start: DesignVector,
        evaluation: &Evaluation,
        method: SearchMethod,
        learning_rate: f64,
    ) -> Self {
        let mut state = Self {
            search: Search::new(method, learning_rate, start.to_flat().len()),
            proposal: start.clone(),
            best: start.clone(),
            design: start.clone(),
            anchor: None,
            known: None,
            history: Vec::new(),
        };
        state.accept(problem, start, evaluation, Setback::default());
        state
    }

    /// The record of the last step.
    pub fn last(&self) -> &StepRecord {
        &self.history[self.history.len() - 1]
    }

    /// The minimum loss of all steps; infinite before the first.
    pub(crate) fn minimum(&self) -> f64 {
        let losses = self.history.iter().map(|record| record.scores.loss);
        losses.fold(f64::INFINITY, f64::min)
    }

    /// Whether the designs of the state have the same dimensions as `start`.
    pub(crate) fn fits(&self, start: &DesignVector) -> bool {
        let designs = [&self.design, &self.proposal, &self.best];
        !self.history.is_empty()
            && designs.iter().all(|design| design.same_shape(start))
            && self.search.fits(start.to_flat().len())
    }

    /// Evaluates the proposal, or the accepted part of that step; the error states why the run ends.
    fn next(
        &mut self,
        problem: &DesignProblem,
    ) -> Result<(DesignVector, Evaluation, Setback), Ended> {
        self.know_a_path(problem);
        let mut rejected = 0;
        loop {
            let proposal = self.proposal.clone();
            let (search, good) = (&self.search, &self.design);
            match evaluate_or_back_off(problem, search, good, proposal, self.known.as_ref()) {
                Ok((design, evaluation, mut setback)) => {
                    setback.halvings += rejected;
                    return Ok((design, evaluation, setback));
                }
                Err(reason) => match (self.search.retry(), reason) {
                    (Some(increment), _) => {
                        self.propose(&increment);
                        rejected += MAX_HALVINGS + 1;
                    }
                    (None, Some(reason)) => return Err(Ended::Stuck { reason }),
                    (None, None) => return Err(Ended::Settled),
                },
            }
        }
    }

    /// Computes the path of the anchor after a pause of the search; forgets it if the next path must be followed.
    fn know_a_path(&mut self, problem: &DesignProblem) {
        let recent = self.history.iter().rev().take(follow_every(problem) - 1);
        match &self.anchor {
            Some(anchor) if recent.clone().any(|record| record.followed) => {
                if self.known.is_none()
                    && let Ok(evaluation) = problem.evaluate(anchor)
                {
                    self.known = Some(evaluation.deployment.known_path());
                }
            }
            _ => self.known = None,
        }
    }

    /// Makes an evaluated design the current one and computes the next proposal.
    fn accept(
        &mut self,
        problem: &DesignProblem,
        design: DesignVector,
        evaluation: &Evaluation,
        setback: Setback,
    ) {
        if evaluation.loss < self.minimum() {
            self.best = design.clone();
        }
        let followed = evaluation.deployment.followed;
        if followed {
            self.anchor = Some(design.clone());
            self.known = (follow_every(problem) > 1).then(|| evaluation.deployment.known_path());
        }
        let gradient = evaluation.gradient.to_flat();
        let x = design.to_flat();
        // A singular tangent has no curvature; the step is then that of L-BFGS.
        let curvature = (self.search.needs_curvature())
            .then(|| problem.shape_curvature(&design, &evaluation.deployment))
            .and_then(Result::ok)
            .map(ShapeCurvature::new);
        let increment = (self.search).increment(&x, evaluation.loss, &gradient, curvature.as_ref());
        self.design = design;
        self.propose(&increment);
        self.history.push(StepRecord {
            step: self.history.len(),
            scores: Scores::of(&problem.objective, evaluation),
            followed,
            halvings: setback.halvings,
            setback: setback.reason,
        });
    }

    fn propose(&mut self, increment: &[f64]) {
        let proposal: Vec<f64> = std::iter::zip(self.design.to_flat(), increment)
            .map(|(coordinate, increment)| coordinate + increment)
            .collect();
        self.proposal = self.design.with_flat(&proposal);
    }
}

/// Every how many steps of a design the path is followed; ideal hinges have no path to correct.
fn follow_every(problem: &DesignProblem) -> usize {
    match &problem.model {
        Model::Ideal { .. } => 1,
        Model::Equilibrium(mechanics) => mechanics.solver.settings.follow_every,
    }
}
