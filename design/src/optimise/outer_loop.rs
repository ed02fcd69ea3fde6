//! The outer loop, Algorithm 1: Adam or L-BFGS on theta = (z, ell, omega).
//!
//! If the sheet of a design has no equilibrium, the step from the last design that had one is halved until
//! an equilibrium exists. Steps depend only on the problem and the search state, so a search continued from
//! a saved state follows the trajectory of an uninterrupted one.

use crate::objective::design_problem::{DesignProblem, Evaluation};
use crate::objective::scores::Scores;
use crate::optimise::backing_off::{MAX_HALVINGS, Setback, evaluate_or_back_off};
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
    /// No step from the last design lowers the loss: a minimum, or a kink that L-BFGS cannot leave.
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
            history: Vec::new(),
        };
        state.accept(problem, start, evaluation, Setback::default());
        state
    }

    /// The record of the last step.
    pub fn last(&self) -> &StepRecord {
        &self.history[self.history.len() - 1]
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
        let mut rejected = 0;
        loop {
            let proposal = self.proposal.clone();
            match evaluate_or_back_off(problem, &self.search, &self.design, proposal) {
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

    /// Makes an evaluated design the current one and computes the next proposal.
    fn accept(
        &mut self,
        problem: &DesignProblem,
        design: DesignVector,
        evaluation: &Evaluation,
        setback: Setback,
    ) {
        let minimum = self
            .history
            .iter()
            .map(|record| record.scores.loss)
            .fold(f64::INFINITY, f64::min);
        if evaluation.loss < minimum {
            self.best = design.clone();
        }
        let gradient = evaluation.gradient.to_flat();
        let x = design.to_flat();
        let increment = self.search.increment(&x, evaluation.loss, &gradient);
        self.design = design;
        self.propose(&increment);
        self.history.push(StepRecord {
            step: self.history.len(),
            scores: Scores::of(&problem.objective, evaluation),
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
