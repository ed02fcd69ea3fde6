//! Running a campaign: workers solve jobs, one dispatcher keeps the books.
//!
//! A job is done when its `result.json` is there, so a run can be killed anywhere: the next one
//! loses at most the jobs in flight. A missing tool or a full disk ends the run at once, as no job
//! would fare better.

use crate::campaign::{Campaign, CampaignError};
use crate::failure::{FailureKind, Rung};
use crate::history::{Event, History, now};
use crate::job::{FileError, JobFolder, JobRecord, JobSpec, ToolVersions};
use crate::ledger::{CampaignFolder, Index, Tally};
use crate::shard::Shard;
use crate::window_solve::{SolveError, Tools, solve_window};
use mesher::tool::ToolError;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

/// Which jobs a run works on, and how.
#[derive(Clone, Copy, Debug)]
pub struct RunOptions {
    pub shard: Shard,
    /// Solves at a time.
    pub workers: usize,
    /// No attempt is started after this time; those in flight are finished.
    pub time_limit: Option<Duration>,
}

/// How a run stands.
#[derive(Clone, Debug)]
pub struct Progress {
    /// All jobs of the shard, those of earlier runs included.
    pub tally: Tally,
    /// Expected time left (s), from the pace of this run; `None` before it has closed a job.
    pub seconds_left: Option<f64>,
}

/// One job of the campaign, as the run found it.
struct Job {
    id: String,
    spec: JobSpec,
    folder: JobFolder,
    record: Option<JobRecord>,
}

impl Job {
    /// A job as it stands in the folder. A record whose rows are not there, as after a crash
    /// between the two, counts for nothing.
    fn found(folder: &CampaignFolder, id: String, spec: JobSpec) -> Result<Self, FileError> {
        let folder = folder.job(&id);
        let record = folder
            .record()?
            .filter(|record| record.rows == 0 || folder.samples(record).is_ok());
        Ok(Self {
            id,
            spec,
            folder,
            record,
        })
    }
}

/// What a worker tells the dispatcher.
enum Message {
    Started {
        job: usize,
        rung: Rung,
    },
    Ended {
        job: usize,
        rung: Rung,
        record: JobRecord,
    },
    /// The run cannot go on.
    Halted(CampaignError),
}

/// How often the dispatcher looks at the stop flag.
const GLANCE: Duration = Duration::from_millis(100);

/// Runs the open jobs of `campaign` in `folder`, and those that have something left to try;
/// `progress` is called at the start and after each attempt.
///
/// Once `stop` is true the solves in flight are ended and the run returns how far it came; the
/// next run goes on from there.
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
    let (next, halt) = (AtomicUsize::new(0), AtomicBool::new(false));
    let (sender, receiver) = mpsc::channel();
    std::thread::scope(|scope| {
        for _ in 0..options.workers.max(1) {
            let (sender, jobs, next, halt) = (sender.clone(), &jobs, &next, &halt);
            let tell = move |message| {
                if sender.send(message).is_err() {
                    // Nobody keeps the books any more.
                    halt.store(true, Ordering::Relaxed);
                }
            };
            let worker = Worker {
                tools,
                limit: campaign.time_limit,
                deadline,
                halt,
            };
            scope.spawn(move || {
                while worker.may_start() {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(job) = jobs.get(index) else { break };
                    if let Err(error) = worker.climb(job, index, &tell) {
                        tell(Message::Halted(error));
                    }
                }
            });
        }
        drop(sender);
        dispatch(receiver, &mut books, stop, &halt, progress)
    })?;
    Ok(books.progress())
}

/// Keeps the books until every worker has left; halts them on an error or on request.
fn dispatch(
    receiver: Receiver<Message>,
    books: &mut Books,
    stop: &AtomicBool,
    halt: &AtomicBool,
    progress: &mut dyn FnMut(&Progress),
) -> Result<(), CampaignError> {
    progress(&books.progress());
    let mut outcome = Ok(());
    loop {
        match receiver.recv_timeout(GLANCE) {
            Ok(message) => {
                outcome = outcome.and(books.note(message));
                progress(&books.progress());
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return outcome,
        }
        if outcome.is_err() || stop.load(Ordering::Relaxed) {
            halt.store(true, Ordering::Relaxed);
        }
    }
}

/// What a worker needs to solve jobs.
#[derive(Clone, Copy)]
struct Worker<'a> {
    tools: &'a Tools,
    /// Time limit of one solve.
    limit: Duration,
    /// When the last attempt may start.
    deadline: Option<Instant>,
    /// Ends the solve in flight.
    halt: &'a AtomicBool,
}

impl Worker<'_> {
    fn may_start(&self) -> bool {
        !self.halt.load(Ordering::Relaxed)
            && self
                .deadline
                .is_none_or(|deadline| Instant::now() < deadline)
    }

    /// Climbs the retry ladder of one job until it is closed or the run ends.
    fn climb(&self, job: &Job, index: usize, tell: &dyn Fn(Message)) -> Result<(), CampaignError> {
        let mut record = job.record.clone();
        while self.may_start()
            && let Some(rung) = record.as_ref().map_or(Some(Rung::AsAsked), |r| r.next)
        {
            tell(Message::Started { job: index, rung });
            let Some(ended) = self.attempt(job, rung, record)? else {
                return Ok(());
            };
            tell(Message::Ended {
                job: index,
                rung,
                record: ended.clone(),
            });
            record = Some(ended);
        }
        Ok(())
    }

    /// Solves a job once and records how it ended; `None` if it was stopped on request.
    ///
    /// The rows that reach furthest are kept.
    fn attempt(
        &self,
        job: &Job,
        rung: Rung,
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
            Some(SolveError::Solver(ToolError::Stopped { .. })) => return Ok(None),
            Some(error) => match FailureKind::of(&error) {
                Some(kind) => Some((kind, error.to_string())),
                None => {
                    let (job, source) = (job.id.clone(), Box::new(error));
                    return Err(CampaignError::Halted { job, source });
                }
            },
        };
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
            job.folder.tidy()?;
        }
        job.folder.write_record(&record)?;
        Ok(Some(record))
    }
}

/// The tally of a run, and its history on disk.
struct Books<'a> {
    jobs: &'a [Job],
    /// Of every job, as it stands now.
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
