//! Rays of a campaign solved in rounds, each with twice the rays of the one before, until weights
//! are accurate.
//!
//! After each round weights are trained on all rays so far, and tested at random states of rays
//! that no training contains.

use crate::rows::collected;
use crate::verification_error::VerificationError;
use dataset::{Database, Row};
use fe_driver::{Campaign, Progress, RunOptions, Shard, Solver, run, status};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use surrogate::{SpotCheck, Surrogate};
use train::{ErrorInterval, spot_check};

/// What is solved, and when it is enough.
#[derive(Clone, Copy)]
pub struct LearningTask<'a> {
    /// All rays; a round solves the first of them.
    pub campaign: &'a Campaign,
    /// Folder of the campaign.
    pub folder: &'a Path,
    /// What solves the rays.
    pub solver: &'a dyn Solver,
    /// Number of solves that run in parallel.
    pub workers: usize,
    /// Number of rays of the first round.
    pub first_rays: usize,
    /// States at which the weights of every round are tested.
    pub spot: &'a [Row],
    /// The errors that are small enough.
    pub accuracy: Accuracy,
    /// No ray is started after this time.
    pub deadline: Option<Instant>,
    /// Terminates the solves in flight when set.
    pub stop: &'a AtomicBool,
}

/// Root mean square errors, relative to the root mean square of the quantity (%).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Of W.
    pub energy: f64,
    /// Of F_a, F_s and M together.
    pub forces: f64,
}

/// One round.
#[derive(Clone, Debug)]
pub struct LearningRound {
    /// Number of rays of all rounds so far.
    pub rays: usize,
    /// Number of rays that the solver followed to their end.
    pub complete: usize,
    /// Solver CPU time of all rays so far (s).
    pub cpu_s: f64,
    /// Time of all trainings of the round (s).
    pub training_s: f64,
    /// Errors of the weights at the states of the spot check.
    pub check: SpotCheck,
    /// The errors of W and of the forces there, with their intervals; `None` if too few rays have
    /// states in the training domain.
    pub intervals: Option<[ErrorInterval; 2]>,
}

/// What a caller does in every round.
pub trait LearningSteps {
    /// Its error.
    type Error: From<VerificationError>;

    /// Shows the progress of the rays.
    fn solving(&mut self, progress: &Progress);

    /// Trains weights on the rows of the first `rays` rays; also returns the time that it took (s).
    fn train(&mut self, rays: usize, database: &Database) -> Result<(Surrogate, f64), Self::Error>;

    /// Takes a finished round with its weights. `is_latest` is false while the rays of the next
    /// round are known from an earlier run: only later weights end the rounds.
    fn round(
        &mut self,
        round: &LearningRound,
        weights: Surrogate,
        is_latest: bool,
    ) -> Result<(), Self::Error>;
}

/// Why the rounds ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LearningEnd {
    /// The weights of the last round are accurate enough.
    Accurate,
    /// Stopped, or at the deadline, with so many rays left.
    Unfinished {
        /// Number of rays.
        left: usize,
        /// Which rays.
        what: &'static str,
    },
    /// All rays are solved, and the errors are too large.
    AllRays,
}

/// Fewest rays on which a round that the deadline ends is trained: a geometry in each part of the
/// split, and some more.
const LEAST_RAYS: usize = 6;

/// Makes rounds until the weights are accurate enough, all rays are solved, or the time is over. A
/// round that the deadline ends early is trained on the rays that it has.
pub fn learn<S: LearningSteps>(task: LearningTask, steps: &mut S) -> Result<LearningEnd, S::Error> {
    let solved = closed_before(task.folder)?;
    let counts = counts(task.first_rays, solved, task.campaign.rays());
    let mut counts = counts.into_iter().peekable();
    let mut trained = 0;
    while let Some(rays) = counts.next() {
        if let Some(end) = solve_first(rays, task, steps)? {
            let tally = status(task.folder).map_err(VerificationError::from)?.tally;
            let stopped = task.stop.load(Ordering::Relaxed);
            // Rays with rows.
            let known = tally.complete + tally.partial;
            if !stopped && known >= LEAST_RAYS && tally.closed() > trained {
                let round = round(tally.closed(), task, true, steps)?;
                if round.is_within(task.accuracy) {
                    return Ok(LearningEnd::Accurate);
                }
            }
            return Ok(end);
        }
        let is_latest = counts.peek().is_none_or(|next| *next > solved);
        let round = round(rays, task, is_latest, steps)?;
        trained = rays;
        if !is_latest {
            continue;
        }
        if round.is_within(task.accuracy) {
            return Ok(LearningEnd::Accurate);
        }
        if let Some(next) = counts.peek()
            && task.deadline.is_some_and(|deadline| Instant::now() >= deadline)
        {
            let (left, what) = (next - rays, "rays of the next round");
            return Ok(LearningEnd::Unfinished { left, what });
        }
    }
    Ok(LearningEnd::AllRays)
}

/// Trains on the `rays` rays that are solved, and tests the weights.
fn round<S: LearningSteps>(
    rays: usize,
    task: LearningTask,
    is_latest: bool,
    steps: &mut S,
) -> Result<LearningRound, S::Error> {
    let database = collected(task.folder)?;
    let (weights, training_s) = steps.train(rays, &database)?;
    let round = LearningRound::new(task, &weights, training_s)?;
    let weights = weights.with_spot_check(round.check.clone());
    steps.round(&round, weights, is_latest)?;
    Ok(round)
}

/// Number of rays that earlier runs have solved.
fn closed_before(folder: &Path) -> Result<usize, VerificationError> {
    if !folder.exists() {
        return Ok(0);
    }
    Ok(status(folder)?.tally.closed())
}

/// Solves the first `rays` rays of the campaign; the end of the rounds if some of them are left.
fn solve_first<S: LearningSteps>(
    rays: usize,
    task: LearningTask,
    steps: &mut S,
) -> Result<Option<LearningEnd>, VerificationError> {
    let options = RunOptions {
        shard: Shard::WHOLE,
        workers: task.workers,
        time_limit: (task.deadline)
            .map(|deadline| deadline.saturating_duration_since(Instant::now())),
        retry: false,
    };
    let first = task.campaign.first_rays(rays);
    let progress = &mut |progress: &Progress| steps.solving(progress);
    let tally = run(&first, task.folder, task.solver, &options, task.stop, progress)?.tally;
    if tally.to_run() > 0 {
        let (left, what) = (tally.to_run(), "rays of this round");
        return Ok(Some(LearningEnd::Unfinished { left, what }));
    }
    if tally.failed > 0 && tally.complete + tally.partial == 0 {
        let jobs = task.folder.join("jobs");
        return Err(VerificationError::EveryRayFailed(jobs));
    }
    Ok(None)
}

impl LearningRound {
    fn new(
        task: LearningTask,
        weights: &Surrogate,
        training_s: f64,
    ) -> Result<Self, VerificationError> {
        let tally = status(task.folder)?.tally;
        let inside = |row: &&Row| weights.contains(&row.design, &row.sample.deformation());
        let inside: Vec<Row> = task.spot.iter().filter(inside).cloned().collect();
        let intervals = ErrorInterval::of(weights, &inside);
        Ok(Self {
            rays: tally.closed(),
            complete: tally.complete,
            cpu_s: tally.cpu_seconds,
            training_s,
            check: spot_check(weights, task.spot, &task.campaign.tier.to_string()),
            intervals: intervals.and_then(|_| ErrorInterval::of(weights, task.spot)),
        })
    }

    fn is_within(&self, accuracy: Accuracy) -> bool {
        let errors = self.intervals.map(|both| both.map(|found| found.error));
        errors.is_some_and(|[w, forces]| w <= accuracy.energy && forces <= accuracy.forces)
    }
}

/// Numbers of rays of the rounds: each twice the one before, the `solved` rays of earlier runs, and
/// the last with all.
fn counts(first: usize, solved: usize, all: usize) -> Vec<usize> {
    let doubled = std::iter::successors(Some(first), |count| Some(2 * count));
    let doubled = doubled.take_while(|count| *count < all);
    let mut counts: Vec<usize> = doubled.chain([solved.max(first).min(all), all]).collect();
    counts.sort_unstable();
    counts.dedup();
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_double_and_end_with_all_rays() {
        assert_eq!(counts(25, 0, 160), [25, 50, 100, 160]);
        assert_eq!(counts(25, 0, 50), [25, 50]);
        assert_eq!(counts(25, 0, 6), [6]);
    }

    #[test]
    fn the_rays_of_a_round_that_was_stopped_are_a_round() {
        assert_eq!(counts(25, 40, 160), [25, 40, 50, 100, 160]);
        assert_eq!(counts(25, 50, 160), [25, 50, 100, 160]);
        assert_eq!(counts(25, 7, 160), [25, 50, 100, 160]);
        assert_eq!(counts(25, 200, 160), [25, 50, 100, 160]);
    }
}
