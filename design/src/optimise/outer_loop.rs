//! The outer loop, Algorithm 1: Adam or L-BFGS on theta = (z, ell, omega).
//!
//! Every few steps the path of the design is followed from the flat sheet; those between are
//! corrected, each from the one before. A corrected path can be on another branch than the followed
//! one. The best design is therefore one whose path was followed: the best of the corrected ones,
//! the candidate, is followed too, unless the next followed design is better. If its loss is
//! another one, the steps since the followed path before it are discarded; the search continues
//! from the best followed design, as from a new start, and follows every path.
//!
//! If the sheet of a design has no equilibrium, the step from the last design that had one is
//! halved until an equilibrium exists. Steps depend only on the problem and the search state, so a
//! search continued from a saved state follows the trajectory of an uninterrupted one.

use crate::{
    equilibrium::warm_start::WarmStart,
    objective::{
        design_problem::{DesignProblem, Evaluation, Model},
        scores::Scores,
    },
    optimise::{
        backing_off::{MAX_HALVINGS, Setback, evaluate_or_back_off},
        search::{Optimiser, SearchMethod},
    },
    pattern::design_vector::DesignVector,
};
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
    /// Whether the path was followed from the flat sheet; `false` if it was corrected from the path
    /// of an earlier design.
    pub followed: bool,
    /// Number of halvings, including the halvings of a step that was given up.
    pub halvings: u32,
    /// Why the first design of the step without objective value had none; `None` if all had one.
    pub setback: Option<String>,
}

/// Why a run ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ended {
    /// All steps were made, or the search has converged where it was to.
    Completed,
    /// Stopped on request; the next run continues.
    Stopped,
    /// No step from the last design lowers the loss by more than rounding: a minimum, or a kink
    /// that L-BFGS cannot leave.
    Settled,
    /// No step from the last design, however small, leads to a design with an equilibrium.
    Stuck {
        /// Why the last design that was tried has no objective value.
        reason: String,
    },
}

/// Everything that the next step depends on, except the problem.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SearchState {
    /// The last design that was evaluated.
    pub(crate) design: DesignVector,
    /// The next design that the search evaluates.
    pub(crate) proposal: DesignVector,
    pub(crate) search: Optimiser,
    /// The design with the minimum loss of those whose path was followed from the flat sheet, also
    /// at a pause.
    pub best: DesignVector,
    /// The design with the minimum loss of those whose path was followed, without those at pauses,
    /// and its loss: the search goes back to it, whether it was paused or not.
    #[serde(rename = "base")]
    best_followed: Scored,
    /// The design with the minimum loss, below the loss of the best followed one, of the designs
    /// whose path was only corrected since.
    candidate: Option<Scored>,
    /// Whether the followed path of a candidate had another loss: since then every path is
    /// followed.
    #[serde(rename = "contradicted")]
    branch_mismatch: bool,
    /// Whether the candidate of the present pause has another loss.
    #[serde(skip)]
    candidate_mismatch: bool,
    /// The last design whose path was followed from the flat sheet and those since, whose paths
    /// were corrected each from the one before.
    #[serde(default)]
    since_followed: Vec<DesignVector>,
    /// The path of the last of them, if it is needed.
    #[serde(skip)]
    known: Option<WarmStart>,
    /// One record per step, beginning with the record of the start.
    pub history: Vec<StepRecord>,
}

/// A design with its loss, and the step in which it was evaluated.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Scored {
    design: DesignVector,
    loss: f64,
    step: usize,
}

/// Relative difference of the losses of a corrected and a followed path on the same branch, unless
/// the tolerance of the equilibria is larger.
const SAME_BRANCH: f64 = 1e-6;

/// When a search ends that can go on.
#[derive(Clone, Copy)]
pub struct Until {
    /// Steps after the start, at most.
    pub steps: usize,
    /// Whether it also ends when it has converged: when 25 steps lower the loss by less than
    /// 0.25 % of it.
    pub converged: bool,
}

impl From<usize> for Until {
    fn from(steps: usize) -> Self {
        Self { steps, converged: false }
    }
}

/// Steps, and the relative fall of the loss over them, of a search that has converged.
const CONVERGED: (usize, f64) = (25, 2.5e-3);

/// Continues the search from `state` until it has made all steps or has converged, until no step
/// lowers the loss, or until the end of the step during which `stop` becomes true.
///
/// `sink` receives the state after every step and may end the search by an error.
pub fn optimise<E>(
    problem: &DesignProblem,
    state: &mut SearchState,
    until: impl Into<Until>,
    stop: &AtomicBool,
    sink: &mut dyn FnMut(&SearchState) -> Result<(), E>,
) -> Result<Ended, E> {
    let until = until.into();
    loop {
        let done = state.history.len() > until.steps || (until.converged && state.has_converged());
        let ended = match (done, stop.load(Ordering::Relaxed)) {
            (true, _) => Ended::Completed,
            (_, true) => Ended::Stopped,
            _ => match state.next(problem) {
                Ok((design, evaluation, setback)) => {
                    state.accept(problem, design, &evaluation, setback);
                    sink(state)?;
                    continue;
                }
                Err(ended) => ended,
            },
        };
        if matches!(ended, Ended::Completed | Ended::Stopped) {
            state.pause(problem);
            return Ok(ended);
        }
        // A search whose last steps are discarded is not at its end.
        match state.confirm(problem) {
            Ok(true) => {}
            Ok(false) => return Ok(ended),
            Err(stuck) => return Ok(stuck),
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
        let search = Optimiser::new(method, learning_rate, start.to_flat().len());
        Self::with(search, problem, start, evaluation)
    }

    /// The same with the optimiser of a search for a similar problem, which knows its curvature.
    pub fn after(
        similar: &Self,
        problem: &DesignProblem,
        start: DesignVector,
        evaluation: &Evaluation,
    ) -> Self {
        Self::with(similar.search.clone().moved(), problem, start, evaluation)
    }

    fn with(
        search: Optimiser,
        problem: &DesignProblem,
        start: DesignVector,
        evaluation: &Evaluation,
    ) -> Self {
        let mut state = Self {
            search,
            proposal: start.clone(),
            best: start.clone(),
            best_followed: Scored { design: start.clone(), loss: evaluation.loss, step: 0 },
            candidate: None,
            branch_mismatch: false,
            candidate_mismatch: false,
            design: start.clone(),
            since_followed: Vec::new(),
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

    /// See [`CONVERGED`].
    fn has_converged(&self) -> bool {
        let (steps, fall) = CONVERGED;
        let loss = self.last().scores.loss;
        let before = self.history.iter().rev().nth(steps);
        before.is_some_and(|before| before.scores.loss - loss < fall * loss)
    }

    /// The design of the last step.
    pub fn last_design(&self) -> &DesignVector {
        &self.design
    }

    /// Whether the designs of the state have the same dimensions as `start`.
    pub fn fits(&self, start: &DesignVector) -> bool {
        let designs = [&self.design, &self.proposal, &self.best, &self.best_followed.design];
        let further = self.candidate.iter().map(|candidate| &candidate.design);
        !self.history.is_empty()
            && (designs.into_iter().chain(further)).all(|design| design.same_shape(start))
            && self.search.fits(start.to_flat().len())
    }

    /// Evaluates the proposal, or the accepted part of that step; the error states why the run
    /// ends.
    fn next(
        &mut self,
        problem: &DesignProblem,
    ) -> Result<(DesignVector, Evaluation, Setback), Ended> {
        // The candidate is followed after a followed design that is not better.
        if self.last().followed {
            self.confirm(problem)?;
        }
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

    /// Computes the path of the last design after a pause of the search as it was found; forgets it
    /// if the next path must be followed.
    fn know_a_path(&mut self, problem: &DesignProblem) {
        if self.since_followed.len() >= self.follow_every(problem) {
            (self.since_followed, self.known) = Default::default();
        }
        if self.known.is_none() {
            for design in &self.since_followed {
                let found = problem.evaluate_near(design, self.known.as_ref()).ok();
                self.known = found.map(|evaluation| evaluation.deployment.warm_start());
            }
        }
    }

    /// Whether a corrected path was on another branch than the followed one.
    pub fn branch_mismatch(&self) -> bool {
        self.branch_mismatch || self.candidate_mismatch
    }

    /// Follows the path of the candidate, which becomes the best followed one if its loss is below
    /// that. Returns whether the followed loss is another one, so that the search went back to the
    /// best followed one.
    fn confirm(&mut self, problem: &DesignProblem) -> Result<bool, Ended> {
        let Some(candidate) = self.candidate.take() else {
            return Ok(false);
        };
        let followed = candidate.followed(problem);
        let (same, step) = (candidate.agrees_with(&followed, problem), candidate.step);
        if followed.loss < self.best_followed.loss {
            self.best = followed.design.clone();
            self.best_followed = followed;
        }
        if !same {
            self.go_back(problem, step)?;
        }
        Ok(!same)
    }

    /// Follows the path of the candidate for the best design, without an effect on the search.
    pub fn pause(&mut self, problem: &DesignProblem) {
        self.best = self.best_followed.design.clone();
        self.candidate_mismatch = false;
        if let Some(candidate) = &self.candidate {
            let followed = candidate.followed(problem);
            self.candidate_mismatch = !candidate.agrees_with(&followed, problem);
            if followed.loss < self.best_followed.loss {
                self.best = followed.design;
            }
        }
    }

    /// Discards the steps since the followed path before a step and continues from the best
    /// followed design, as from a new start.
    fn go_back(&mut self, problem: &DesignProblem, step: usize) -> Result<(), Ended> {
        let evaluation = problem.evaluate(&self.best_followed.design);
        let evaluation = evaluation.map_err(|error| Ended::Stuck { reason: error.to_string() })?;
        let before = self.history[..step].iter().rposition(|record| record.followed);
        self.history.truncate(before.map_or(1, |last| last + 1));
        self.branch_mismatch = true;
        (self.since_followed, self.known) = Default::default();
        self.search = self.search.restarted();
        self.go_on(self.best_followed.design.clone(), &evaluation);
        Ok(())
    }

    /// Makes an evaluated design the current one and computes the next proposal.
    fn accept(
        &mut self,
        problem: &DesignProblem,
        design: DesignVector,
        evaluation: &Evaluation,
        setback: Setback,
    ) {
        let (followed, loss) = (evaluation.deployment.followed, evaluation.loss);
        let scored = Scored { design: design.clone(), loss, step: self.history.len() };
        let lowest = self.candidate.as_ref().unwrap_or(&self.best_followed).loss;
        match followed {
            true if loss < self.best_followed.loss => {
                self.candidate.take_if(|candidate| candidate.loss >= loss);
                self.best = design.clone();
                self.best_followed = scored;
            }
            false if loss < lowest => self.candidate = Some(scored),
            _ => {}
        }
        if followed {
            self.since_followed.clear();
        }
        if self.follow_every(problem) > 1 {
            self.since_followed.push(design.clone());
            self.known = Some(evaluation.deployment.warm_start());
        }
        self.go_on(design, evaluation);
        self.history.push(StepRecord {
            step: self.history.len(),
            scores: Scores::new(&problem.objective, evaluation),
            followed,
            halvings: setback.halvings,
            setback: setback.reason,
        });
    }

    /// Computes the proposal that follows an evaluated design.
    fn go_on(&mut self, design: DesignVector, evaluation: &Evaluation) {
        let gradient = evaluation.gradient.to_flat();
        let x = design.to_flat();
        let increment = (self.search).increment(&x, evaluation.loss, &gradient);
        self.design = design;
        self.propose(&increment);
    }

    fn propose(&mut self, increment: &[f64]) {
        let proposal: Vec<f64> = std::iter::zip(self.design.to_flat(), increment)
            .map(|(coordinate, increment)| coordinate + increment)
            .collect();
        self.proposal = self.design.with_flat(&proposal);
    }

    /// Every how many steps of a design the path is followed; ideal hinges have no path to correct.
    fn follow_every(&self, problem: &DesignProblem) -> usize {
        match &problem.model {
            Model::Equilibrium(mechanics) if !self.branch_mismatch => {
                mechanics.solver.settings.follow_every
            }
            _ => 1,
        }
    }
}

impl Scored {
    /// The same design with the loss of its followed path; infinite if there is none.
    fn followed(&self, problem: &DesignProblem) -> Self {
        Self { loss: problem.loss(&self.design).unwrap_or(f64::INFINITY), ..self.clone() }
    }

    /// Whether the path of `followed` is on the same branch.
    fn agrees_with(&self, followed: &Self, problem: &DesignProblem) -> bool {
        let tolerance = match &problem.model {
            Model::Ideal { .. } => SAME_BRANCH,
            Model::Equilibrium(mechanics) => SAME_BRANCH.max(mechanics.solver.settings.tolerance),
        };
        (followed.loss - self.loss).abs() <= tolerance * self.loss.abs()
    }
}
