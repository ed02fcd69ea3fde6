//! The outer loop, Algorithm 1: Adam, L-BFGS or Gauss-Newton on theta = (z, ell, omega).
//!
//! Every few steps the path of the design is followed from the flat sheet; those between are corrected from that path.
//! A corrected path can be on another branch than the followed one. The best design is therefore one whose path was
//! followed: the best of the designs since the last followed path is followed too, before the next one and at the end. If
//! its loss is another one, these designs are discarded, and the search continues from the best design and follows every
//! path.
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
    /// The design with the minimum loss of those whose path was followed from the flat sheet.
    pub best: DesignVector,
    /// The loss of `best`.
    best_loss: f64,
    /// The design with the minimum loss, below `best_loss`, of those whose path was only corrected.
    candidate: Option<Candidate>,
    /// Whether the followed path of a candidate had another loss: since then every path is followed.
    pub contradicted: bool,
    /// The last design whose path was followed from the flat sheet.
    anchor: Option<DesignVector>,
    /// The path of the anchor, if it is needed.
    #[serde(skip)]
    known: Option<KnownPath>,
    /// One record per step, beginning with that of the start.
    pub history: Vec<StepRecord>,
}

/// A design with the loss of its corrected path.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Candidate {
    design: DesignVector,
    loss: f64,
}

/// Relative difference of the losses of a corrected and a followed path on the same branch, unless the tolerance of the
/// equilibria is larger.
const SAME_BRANCH: f64 = 1e-6;

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
        let ended = match (state.history.len() > steps, stop.load(Ordering::Relaxed)) {
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
        // A search whose last steps are discarded is not at its end.
        match state.confirm(problem) {
            Ok(discarded) if discarded && ended != Ended::Stopped => {}
            Ok(_) => return Ok(ended),
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
        let mut state = Self {
            search: Search::new(method, learning_rate, start.to_flat().len()),
            proposal: start.clone(),
            best: start.clone(),
            best_loss: f64::INFINITY,
            candidate: None,
            contradicted: false,
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

    /// Whether the designs of the state have the same dimensions as `start`.
    pub(crate) fn fits(&self, start: &DesignVector) -> bool {
        let designs = [&self.design, &self.proposal, &self.best];
        let further = self.candidate.iter().map(|candidate| &candidate.design);
        !self.history.is_empty()
            && (designs.into_iter().chain(further)).all(|design| design.same_shape(start))
            && self.search.fits(start.to_flat().len())
    }

    /// Evaluates the proposal, or the accepted part of that step; the error states why the run ends.
    fn next(
        &mut self,
        problem: &DesignProblem,
    ) -> Result<(DesignVector, Evaluation, Setback), Ended> {
        if !self.knows_a_path(problem) {
            self.confirm(problem)?;
        }
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

    /// Whether there is a path from which the next one can be corrected: that of the anchor, which is computed again
    /// after a pause of the search. It is forgotten if the next path must be followed.
    fn knows_a_path(&mut self, problem: &DesignProblem) -> bool {
        let recent = self
            .history
            .iter()
            .rev()
            .take(self.follow_every(problem) - 1);
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
        self.known.is_some()
    }

    /// Follows the path of the candidate, which becomes the best design if its loss is below that of the best. Returns
    /// whether the followed loss is another one, so that the search went back to the best design.
    fn confirm(&mut self, problem: &DesignProblem) -> Result<bool, Ended> {
        let Some(Candidate { design, loss }) = self.candidate.take() else {
            return Ok(false);
        };
        let followed = problem.loss(&design).unwrap_or(f64::INFINITY);
        if followed < self.best_loss {
            (self.best, self.best_loss) = (design, followed);
        }
        let same = (followed - loss).abs() <= same_branch(problem) * loss.abs();
        if !same {
            self.go_back(problem)?;
        }
        Ok(!same)
    }

    /// Discards the steps since the last followed path and continues from the best design, as from a new start.
    fn go_back(&mut self, problem: &DesignProblem) -> Result<(), Ended> {
        let evaluation = problem.evaluate(&self.best);
        let evaluation = evaluation.map_err(|error| Ended::Stuck {
            reason: error.to_string(),
        })?;
        let followed = self.history.iter().rposition(|record| record.followed);
        self.history.truncate(followed.map_or(1, |last| last + 1));
        self.contradicted = true;
        (self.anchor, self.known) = (None, None);
        self.search = self.search.restarted();
        self.go_on(problem, self.best.clone(), &evaluation);
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
        let least = self.candidate.as_ref().map_or(self.best_loss, |it| it.loss);
        match followed {
            true if loss < self.best_loss => {
                (self.best, self.best_loss) = (design.clone(), loss);
                self.candidate.take_if(|candidate| candidate.loss >= loss);
            }
            false if loss < least => {
                let design = design.clone();
                self.candidate = Some(Candidate { design, loss });
            }
            _ => {}
        }
        if followed {
            self.anchor = Some(design.clone());
            self.known =
                (self.follow_every(problem) > 1).then(|| evaluation.deployment.known_path());
        }
        self.go_on(problem, design, evaluation);
        self.history.push(StepRecord {
            step: self.history.len(),
            scores: Scores::of(&problem.objective, evaluation),
            followed,
            halvings: setback.halvings,
            setback: setback.reason,
        });
    }

    /// Computes the proposal that follows an evaluated design.
    fn go_on(&mut self, problem: &DesignProblem, design: DesignVector, evaluation: &Evaluation) {
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
            Model::Equilibrium(mechanics) if !self.contradicted => {
                mechanics.solver.settings.follow_every
            }
            _ => 1,
        }
    }
}

fn same_branch(problem: &DesignProblem) -> f64 {
    match &problem.model {
        Model::Ideal { .. } => SAME_BRANCH,
        Model::Equilibrium(mechanics) => SAME_BRANCH.max(mechanics.solver.settings.tolerance),
    }
}
