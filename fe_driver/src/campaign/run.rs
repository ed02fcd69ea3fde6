//! Running a campaign: workers solve jobs, and one thread records their state.
//!
//! A job is done when its `result.json` exists. A run can therefore be killed at any time; at most the jobs in
//! flight are lost. A missing tool or a full disk stops the run immediately, because every other job would
//! fail too.

use crate::campaign::definition::{Campaign, CampaignError};
use crate::campaign::history::{Event, History, now};
use crate::campaign::job::{JobFolder, JobRecord, JobSpec};
use crate::campaign::ledger::{CampaignFolder, Index, Tally};
use crate::record_file::FileError;
use crate::window::failure::{FailureKind, RetryStep};
use crate::window::solve::{SolveError, Tools, solve_window};
use crate::window::versions::ToolVersions;
use mesher::MeshError;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use support::program::ToolError;
use support::shard::Shard;
use support::worker_pool::{Reports, work_through};

/// Which jobs a run works on, and how.
#[derive(Clone, Copy, Debug)]
pub struct RunOptions {
    /// The part of the jobs that the run works on.
    pub shard: Shard,
    /// Number of solves that run in parallel.
    pub workers: usize,
    /// No attempt is started after this time; attempts in flight are finished.
    pub time_limit: Option<Duration>,
}

/// The progress of a run.
#[derive(Clone, Debug)]
pub struct Progress {
    /// All jobs of the shard, including those of earlier runs.
    pub tally: Tally,
    /// Estimated remaining time (s), from the rate of this run; `None` before it has closed a job.
    pub seconds_left: Option<f64>,
}

/// One job of the campaign, with its state at the start of the run.
struct Job {
    id: String,
    spec: JobSpec,
    folder: JobFolder,
    record: Option<JobRecord>,
}

impl Job {
    /// Reads the state of a job from its folder. A record without matching rows, as left by a crash, is ignored.
    fn found(folder: &CampaignFolder, id: String, spec: JobSpec) -> Result<Self, FileError> {
        let folder = folder.job(&id);
        Ok(Self {
            id,
            spec,
            record: folder.ended()?,
            folder,
        })
    }
}

/// A message from a worker.
enum Message {
    /// The record of a job when a worker takes it up; another host may have changed it since the run began.
    Found {
        job: usize,
        record: Option<JobRecord>,
    },
    Started {
        job: usize,
        rung: RetryStep,
    },
    Ended {
        job: usize,
        rung: RetryStep,
        record: JobRecord,
    },
    /// The run cannot continue.
    Halted(CampaignError),
}

/// Runs the open jobs of `campaign` in `folder`, and the failed jobs that have a retry left.
/// `progress` is called at the start and after each message of a worker.
///
/// When `stop` becomes true, the solves in flight are terminated and the run returns its progress. The
/// next run continues from there.
pub fn run(
    campaign: &Campaign,
    folder: &Path,
    tools: &Tools,
    options: &RunOptions,
    stop: &AtomicBool,
    progress: &mut dyn FnMut(&Progress),
) -> Result<Progress, CampaignError> {
    let deadline = options.time_limit.map(|limit| Instant::now() + limit);
    let folder = CampaignFolder(folder.to_owned());
    let specs = campaign.jobs(&ToolVersions::of(tools));
    let index = Index::of(&campaign.name, &specs);
    let history = folder.enter(options.shard, &index)?;
    let jobs = index
        .jobs
        .into_iter()
        .zip(specs)
        .enumerate()
        .filter(|(place, _)| options.shard.holds(*place))
        .map(|(_, (id, spec))| Job::found(&folder, id, spec))
        .collect::<Result<Vec<_>, _>>()?;

    let mut books = Books::new(history, &jobs);
    progress(&books.progress());
    let work = |index: usize, reports: &Reports<Message>| {
        let worker = Worker {
            tools,
            limit: campaign.time_limit,
            deadline,
            halt: reports.halt(),
        };
        if let Err(error) = worker.climb(&jobs[index], index, reports) {
            reports.send(Message::Halted(error));
        }
    };
    work_through(jobs.len(), options.workers, stop, &work, &mut |message| {
        let noted = books.note(message);
        progress(&books.progress());
        noted
    })?;
    Ok(books.progress())
}

/// A worker, which solves jobs.
#[derive(Clone, Copy)]
struct Worker<'a> {
    tools: &'a Tools,
    /// Time limit of one solve.
    limit: Duration,
    /// Time after which no attempt is started.
    deadline: Option<Instant>,
    /// Terminates the solve in flight when set.
    halt: &'a AtomicBool,
}

impl Worker<'_> {
    fn may_start(&self) -> bool {
        !self.halt.load(Ordering::Relaxed)
            && self
                .deadline
                .is_none_or(|deadline| Instant::now() < deadline)
    }

    /// Makes the attempts of the retry ladder of one job until the job is closed or the run ends.
    fn climb(
        &self,
        job: &Job,
        index: usize,
        reports: &Reports<Message>,
    ) -> Result<(), CampaignError> {
        if !self.may_start() {
            return Ok(());
        }
        let mut record = job.folder.ended()?;
        reports.send(Message::Found {
            job: index,
            record: record.clone(),
        });
        while self.may_start()
            && let Some(rung) = record.as_ref().map_or(Some(RetryStep::AsAsked), |r| r.next)
        {
            reports.send(Message::Started { job: index, rung });
            let Some(ended) = self.attempt(job, rung, record)? else {
                return Ok(());
            };
            reports.send(Message::Ended {
                job: index,
                rung,
                record: ended.clone(),
            });
            record = Some(ended);
        }
        Ok(())
    }

    /// Makes one attempt at a job and records its result; `None` if it was stopped on request.
    ///
    /// The rows of the attempt that reached the largest lambda are kept. If another host has recorded an attempt in the
    /// meantime, its record is returned, and that of this attempt is dropped.
    fn attempt(
        &self,
        job: &Job,
        rung: RetryStep,
        before: Option<JobRecord>,
    ) -> Result<Option<JobRecord>, CampaignError> {
        let start = Instant::now();
        let problem = rung.problem(&job.spec.problem);
        job.folder.write_spec(&job.spec)?;
        let work = job.folder.fresh_work()?;
        let (samples, error, cpu_seconds) =
            match solve_window(&problem, self.tools, &work, self.limit, self.halt) {
                Ok(solution) => (solution.samples, solution.stopped, solution.cpu_seconds),
                Err(error) => (Vec::new(), Some(error), None),
            };
        let failure = match error {
            None => None,
            Some(
                SolveError::Solver(ToolError::Stopped { .. })
                | SolveError::Mesh(MeshError::Gmsh(ToolError::Stopped { .. })),
            ) => return Ok(None),
            Some(error) => match FailureKind::of(&error) {
                Some(kind) => Some((kind, error.to_string())),
                None => {
                    let (job, source) = (job.id.clone(), Box::new(error));
                    return Err(CampaignError::Halted { job, source });
                }
            },
        };
        if let Some(theirs) = job
            .folder
            .ended()?
            .filter(|now| before.as_ref() != Some(now))
        {
            job.folder.remove_work()?;
            return Ok(Some(theirs));
        }
        let mut record = before.unwrap_or_default();
        if let Some(last) = samples.last()
            && last.lambda > record.lambda
        {
            record.rows_hash = job.folder.write_samples(&samples)?;
            record.rows = samples.len();
            record.lambda = last.lambda;
            record.tier = problem.tier;
        }
        record.next = failure
            .as_ref()
            .and_then(|(kind, _)| kind.next(rung, job.spec.problem.tier, record.lambda));
        (record.failure, record.message) = failure.unzip();
        record.attempts += 1;
        record.cpu_seconds += cpu_seconds.unwrap_or(0.0);
        record.wall_seconds += start.elapsed().as_secs_f64();
        record.ended = now();
        if record.failure.is_none() {
            job.folder.remove_work()?;
        }
        job.folder.write_record(&record)?;
        Ok(Some(record))
    }
}

/// The job records of a run, and its history on disk.
struct Books<'a> {
    jobs: &'a [Job],
    /// The current record of every job.
    records: Vec<Option<JobRecord>>,
    history: History,
    start: Instant,
    closed_before: usize,
}

impl<'a> Books<'a> {
    fn new(history: History, jobs: &'a [Job]) -> Self {
        let records: Vec<_> = jobs.iter().map(|job| job.record.clone()).collect();
        Self {
            jobs,
            closed_before: Tally::of(&records).closed(),
            records,
            history,
            start: Instant::now(),
        }
    }

    fn note(&mut self, message: Message) -> Result<(), CampaignError> {
        match message {
            Message::Found { job, record } => self.records[job] = record,
            Message::Started { job, rung } => {
                self.history
                    .note(&self.jobs[job].id, Event::Started { rung })?;
            }
            Message::Ended { job, rung, record } => {
                let event = Event::Ended {
                    rung,
                    record: &record,
                };
                self.history.note(&self.jobs[job].id, event)?;
                self.records[job] = Some(record);
            }
            Message::Halted(error) => return Err(error),
        }
        Ok(())
    }

    fn progress(&self) -> Progress {
        let tally = Tally::of(&self.records);
        let closed = tally.closed() - self.closed_before;
        let pace = self.start.elapsed().as_secs_f64() / closed as f64;
        Progress {
            seconds_left: (closed > 0).then(|| pace * tally.to_run() as f64),
            tally,
        }
    }
}
