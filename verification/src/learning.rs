//! Rays of a campaign solved in rounds, each with twice the rays of the one before, until weights
//! are accurate.
//!
//! After each round weights are trained on all rays so far, and tested at random states of rays
//! that no training contains.

use crate::solved_rays::collected;
use crate::verification_error::{VerificationError, every_ray_failed};
use dataset::{Database, SolvedRay};
use fe_driver::{Campaign, CampaignProgress, RunOptions, Shard, Solver, run, status};
use std::collections::VecDeque;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use support::table::{Cell, Columns, Table};
use surrogate::{SpotCheck, Surrogate};
use train::{ErrorInterval, inside, spot_check};

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
    pub spot: &'a [SolvedRay],
    /// The errors that are small enough.
    pub accuracy: Accuracy,
    /// No ray is started after this time.
    pub deadline: Option<Instant>,
    /// Terminates the solves in flight when set.
    pub stop: &'a AtomicBool,
}

/// Root mean square errors, relative to the root mean square of the quantity (%).
#[derive(Clone, Copy, Debug)]
pub struct Accuracy {
    /// Error of W.
    pub energy: f64,
    /// Error of F_a, F_s and M together.
    pub forces: f64,
}

/// One round.
#[derive(Debug)]
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
    /// `false` while an earlier run has solved rays of the next round: only later weights end the
    /// rounds.
    pub is_latest: bool,
}

/// Why the rounds ended.
#[derive(Clone, Copy, Debug, PartialEq)]
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

/// Minimum number of rays on which a round that the deadline ends is trained: a geometry in each part of the
/// split, and some more.
const LEAST_RAYS: usize = 6;

/// The rounds until the weights are accurate enough, all rays are solved, or the time is over. A
/// round that the deadline ends early is trained on the rays that it has.
pub struct Learning<'a> {
    task: LearningTask<'a>,
    /// Number of rays that earlier runs have solved.
    solved: usize,
    /// Numbers of rays of the rounds that are left.
    counts: VecDeque<usize>,
    /// Number of rays of the last training.
    trained: usize,
    is_latest: bool,
    end: Option<LearningEnd>,
}

impl<'a> Learning<'a> {
    /// The rounds that earlier runs have left; nothing is solved yet.
    pub fn new(task: LearningTask<'a>) -> Result<Self, VerificationError> {
        let folder = task.folder;
        let solved = if folder.exists() { status(folder)?.tally.closed() } else { 0 };
        let counts = counts(task.first_rays, solved, task.campaign.rays()).into();
        Ok(Self { task, solved, counts, trained: 0, is_latest: false, end: None })
    }

    /// Solves the rays of the next round. Returns the database of all rays so far, to train weights on,
    /// with the number of their rays, or why there is no further round.
    pub fn solve(
        &mut self,
        progress: &mut dyn FnMut(&CampaignProgress),
    ) -> Result<Result<(usize, Database), LearningEnd>, VerificationError> {
        if let Some(end) = self.end {
            return Ok(Err(end));
        }
        let Some(mut rays) = self.counts.pop_front() else {
            return Ok(Err(LearningEnd::AllRays));
        };
        let task = &self.task;
        let options = RunOptions {
            shard: Shard::WHOLE,
            workers: task.workers,
            time_limit: (task.deadline)
                .map(|deadline| deadline.saturating_duration_since(Instant::now())),
            retry: false,
        };
        let first = task.campaign.first_rays(rays);
        let tally = run(&first, task.folder, task.solver, &options, task.stop, progress)?.tally;
        self.is_latest = self.counts.front().is_none_or(|next| *next > self.solved);
        if tally.to_run() > 0 {
            let (left, what) = (tally.to_run(), "rays of this round");
            let end = LearningEnd::Unfinished { left, what };
            let tally = status(task.folder)?.tally;
            let with_rows = tally.complete + tally.partial;
            rays = tally.closed();
            if task.stop.load(Ordering::Relaxed) || with_rows < LEAST_RAYS || rays <= self.trained {
                return Ok(Err(end));
            }
            (self.end, self.is_latest) = (Some(end), true);
        } else if tally.failed > 0 && tally.complete + tally.partial == 0 {
            return Err(every_ray_failed(task.folder).into());
        }
        self.trained = rays;
        Ok(Ok((rays, collected(task.folder)?)))
    }

    /// Tests the weights of a round, whose training took `training_s`, and records the errors on
    /// their card.
    pub fn test(
        &mut self,
        weights: Surrogate,
        training_s: f64,
    ) -> Result<(LearningRound, Surrogate), VerificationError> {
        let task = &self.task;
        let tally = status(task.folder)?.tally;
        let intervals = ErrorInterval::of(&weights, &inside(&weights, task.spot));
        let round = LearningRound {
            rays: tally.closed(),
            complete: tally.complete,
            cpu_s: tally.cpu_seconds,
            training_s,
            check: spot_check(&weights, task.spot, &task.campaign.tier.to_string()),
            intervals: intervals.and_then(|_| ErrorInterval::of(&weights, task.spot)),
            is_latest: self.is_latest,
        };
        let Accuracy { energy, forces } = task.accuracy;
        let accurate =
            (round.intervals).is_some_and(|[w, other]| w.error <= energy && other.error <= forces);
        if accurate && self.is_latest {
            self.end = Some(LearningEnd::Accurate);
        } else if let Some(next) = self.counts.front()
            && self.is_latest
            && self.end.is_none()
            && task.deadline.is_some_and(|deadline| Instant::now() >= deadline)
        {
            let (left, what) = (next - self.trained, "rays of the next round");
            self.end = Some(LearningEnd::Unfinished { left, what });
        }
        let weights = weights.with_spot_check(round.check.clone());
        Ok((round, weights))
    }
}

impl LearningRound {
    /// The rounds, one a row; `-` if an error is unknown, without its interval if it has none.
    pub fn table(rounds: &[Self]) -> Table {
        let mut columns = Columns::new()
            .column("rays", |round: &Self| round.rays)
            .column("to their end", |round| {
                Cell::percent(round.complete as f64 / round.rays as f64, 0)
            })
            .column("solver CPU\ns", |round| Cell::fixed(round.cpu_s, 0))
            .column("training\ns", |round| Cell::fixed(round.training_s, 0))
            .column("states", |round| round.check.errors.rows)
            .column("inside", |round| round.check.inside);
        let names = ["W\n%", "F_a\n%", "F_s\n%", "M\n%", "D\n%", "D_peak\n%"];
        for (i, name) in names.into_iter().enumerate() {
            columns =
                columns.column(name, move |round| Cell::fixed(round.check.errors.percents()[i], 2));
        }
        columns
            .column("forces\n%", |round| Cell::fixed(round.check.errors.forces_percent(), 2))
            .column("W, 95 %", |round| interval(round, 0))
            .column("forces, 95 %", |round| interval(round, 1))
            .table(rounds)
    }
}

fn interval(round: &LearningRound, which: usize) -> String {
    let intervals = round.intervals.as_ref();
    intervals.map_or("-".into(), |both| {
        let [low, high] = both[which].interval;
        format!("{low:.2} to {high:.2}")
    })
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
