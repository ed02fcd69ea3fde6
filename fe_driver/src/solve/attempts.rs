//! Works through a list of solves: workers make the attempts, and one thread hears of them.
//!
//! A solve is done when its `result.json` exists. A run can therefore be killed at any time; at
//! most the attempts in flight are lost. A missing tool or a full disk ends the run immediately,
//! because every other solve would fail too. What the machine does to an attempt, as a kill,
//! decides nothing of a result: the same attempt is made again, a few times, and the solve then
//! stays open.

use crate::{
    AttemptKind, Cause, Solution, Solve, SolveFolder, SolveRecord, SolvedPath, Solver, WindowSolve,
};
use serde::Serialize;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};
use support::worker_pool::{NoThread, Reports, work_through};
use support::{Fault, FileError, refuse};

/// Why a list of solves ended before its last solve. What was solved until then is kept.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum SolveListError {
    #[error(transparent)]
    Fault(#[from] Fault),
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Thread(#[from] NoThread),
    #[error("stopped with {left} solves left")]
    Stopped { left: usize },
}

/// Number of times that an attempt is made which the machine ends.
const TRIES: usize = 3;

/// One solve of a list.
#[derive(Debug)]
pub(crate) struct Job<S: Solve = WindowSolve> {
    pub id: String,
    pub solve: S,
    pub folder: SolveFolder,
}

/// How a list is worked through.
pub(crate) struct Workers<'a, S: Solve = WindowSolve> {
    pub solver: &'a dyn Solver<S>,
    /// Number of solves that run in parallel.
    pub count: usize,
    /// Time limit of one attempt.
    pub limit: Duration,
    /// Time after which no attempt is started.
    pub deadline: Option<Instant>,
}

/// An event at a solve of a list, as a history states it.
#[derive(Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum SolveEvent {
    /// Its record when a worker takes it up; another process may have changed it since the list was
    /// made. No history states it.
    #[serde(skip)]
    Found(Option<SolveRecord>),
    Started {
        attempt: AttemptKind,
    },
    /// The machine ended the attempt, for this reason.
    Disturbed {
        attempt: AttemptKind,
        reason: String,
    },
    Ended {
        attempt: AttemptKind,
        record: SolveRecord,
    },
    Reopened,
    Restored,
}

impl<S: Solve> Workers<'_, S> {
    /// Makes the attempts that are left at every job, each until it is closed. `note` hears of
    /// every event at a job, by its place in the list.
    ///
    /// When `stop` becomes true, the attempts in flight are terminated and not counted. A later run
    /// continues from there.
    pub(crate) fn work_through(
        &self,
        jobs: &[Job<S>],
        stop: &AtomicBool,
        note: &mut dyn FnMut(usize, SolveEvent) -> Result<(), FileError>,
    ) -> Result<(), SolveListError> {
        let work = |index: usize, reports: &Reports<_>| {
            let report = |event| reports.send((index, Ok(event)));
            if let Err(error) = self.solve(&jobs[index], reports.halt(), &report) {
                reports.send((index, Err(error)));
            }
        };
        work_through(jobs.len(), self.count, stop, &work, &mut |(index, event)| {
            Ok(note(index, event?)?)
        })
    }

    /// Makes the attempts at one job until it is closed or the run ends.
    fn solve(
        &self,
        job: &Job<S>,
        halt: &AtomicBool,
        report: &dyn Fn(SolveEvent),
    ) -> Result<(), SolveListError> {
        let may_start = || {
            let in_time = |deadline| Instant::now() < deadline;
            !halt.load(Ordering::Relaxed) && self.deadline.is_none_or(in_time)
        };
        if !may_start() {
            return Ok(());
        }
        let mut record = job.folder.ended::<S>()?;
        report(SolveEvent::Found(record.clone()));
        let mut disturbed = 0;
        while may_start()
            && disturbed < TRIES
            && let Some(attempt) =
                (record.as_ref()).map_or(Some(AttemptKind::Requested), |record| record.next)
        {
            report(SolveEvent::Started { attempt });
            let Some(event) = self.attempt(job, attempt, record.clone(), halt)? else {
                return Ok(());
            };
            match &event {
                SolveEvent::Ended { record: ended, .. } => {
                    disturbed = 0;
                    record = Some(ended.clone());
                }
                _ => disturbed += 1,
            }
            report(event);
        }
        Ok(())
    }

    /// Makes one attempt at a job and records its result, unless the machine ended it; `None` if it
    /// was ended on request.
    ///
    /// The samples of the attempt that reached the largest lambda are kept. If another process has
    /// recorded an attempt in the meantime, its record is returned, and the record of this attempt
    /// is dropped.
    fn attempt(
        &self,
        job: &Job<S>,
        attempt: AttemptKind,
        before: Option<SolveRecord>,
        halt: &AtomicBool,
    ) -> Result<Option<SolveEvent>, SolveListError> {
        let start = Instant::now();
        let solve = job.solve.attempted(attempt);
        job.folder.write_solve(&job.solve)?;
        let work = job.folder.fresh_work()?;
        let (solution, error) = match self.solver.attempt(&solve, &work, self.limit, halt) {
            Ok(mut solution) => {
                let stopped = solution.stopped.take();
                (solution, stopped)
            }
            Err(error) => (Solution::default(), Some(error)),
        };
        let failure = match error {
            None => None,
            Some(error) => match error.cause {
                Cause::Stop => return Ok(None),
                Cause::Problem(kind) => Some((kind, error.message)),
                Cause::Machine => {
                    job.folder.keep_work()?;
                    return Ok(Some(SolveEvent::Disturbed { attempt, reason: error.message }));
                }
                Cause::Run => {
                    refuse!("the run was stopped by an error at job {}: {error}", job.id)
                }
            },
        };
        let now = job.folder.ended::<S>()?;
        if let Some(record) = now.filter(|now| before.as_ref() != Some(now)) {
            job.folder.remove_work()?;
            return Ok(Some(SolveEvent::Ended { attempt, record }));
        }
        let mut record = before.unwrap_or_default();
        let reached = solution.samples.reached();
        if reached > record.lambda {
            record.rows_hash = job.folder.write_samples(&solution.samples)?;
            record.rows = solution.samples.len();
            record.lambda = reached;
            record.tier = solve.tier();
            record.elements = solution.elements;
        }
        record.next = (failure.as_ref())
            .and_then(|(kind, _)| job.solve.next_attempt(attempt, *kind, record.lambda));
        (record.failure, record.message) = failure.unzip();
        record.attempts += 1;
        record.add_cost(&solution, start.elapsed());
        if record.failure.is_none() {
            job.folder.remove_work()?;
        } else {
            job.folder.keep_work()?;
        }
        job.folder.write_record(&record)?;
        Ok(Some(SolveEvent::Ended { attempt, record }))
    }
}

impl SolveRecord {
    /// Adds what an attempt that has just ended has cost.
    fn add_cost<P>(&mut self, solution: &Solution<P>, wall: Duration) {
        self.iterations += solution.iterations;
        self.cpu_seconds += solution.cpu_seconds.unwrap_or(0.0);
        self.wall_seconds += wall.as_secs_f64();
        self.solver_seconds += solution.solver_seconds;
        let memories = [self.peak_memory_mib, solution.peak_memory_mib];
        self.peak_memory_mib = memories.into_iter().flatten().reduce(f64::max);
        self.ended = now();
    }
}

/// Seconds since 1970.
pub(crate) fn now() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}
