//! Running a campaign: workers solve jobs, one dispatcher keeps the books.
//!
//! A job is done when its `result.json` is there, so a run can be killed anywhere: the next one
//! loses at most the jobs in flight. A missing tool or a full disk ends the run at once, as no job
//! would fare better.

use crate::campaign::{Campaign, CampaignError};
use crate::failure::{FailureKind, Rung};
use crate::job::{FileError, JobFolder, JobRecord, JobSpec, ToolVersions};
use crate::ledger::{CampaignFolder, Tally};
use crate::window_solve::{SolveError, Tools, solve_window};
use mesher::tool::ToolError;
use serde::Serialize;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// How a run stands.
#[derive(Clone, Debug)]
pub struct Progress {
    /// All jobs of the campaign, those of earlier runs included.
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

/// Runs the open jobs of `campaign` in `folder`, and those that have something left to try, with
/// `workers` solves at a time; `progress` is called at the start and after each attempt.
///
/// Once `stop` is true the solves in flight are ended and the run returns how far it came; the
/// next run goes on from there.
pub fn run(
    campaign: &Campaign,
    folder: &Path,
    tools: &Tools,
    workers: usize,
    stop: &AtomicBool,
    progress: &mut dyn FnMut(&Progress),
) -> Result<Progress, CampaignError> {
    std::fs::create_dir_all(folder).map_err(FileError::at(folder))?;
    let _lock = lock(folder)?;
    let folder = CampaignFolder(folder.to_owned());
    folder.belongs_to(campaign)?;
    let jobs = campaign
        .jobs(&ToolVersions::of(tools))
        .into_iter()
        .map(|spec| {
            let id = spec.id();
            let folder = folder.job(&id);
            let record = folder.record()?;
            Ok(Job {
                id,
                spec,
                folder,
                record,
            })
        })
        .collect::<Result<Vec<_>, FileError>>()?;
    folder.write_index(
        &campaign.name,
        jobs.iter().map(|job| job.id.clone()).collect(),
    )?;

    let mut books = Books::open(&folder, &jobs)?;
    let (next, halt) = (AtomicUsize::new(0), AtomicBool::new(false));
    let (sender, receiver) = mpsc::channel();
    std::thread::scope(|scope| {
        for _ in 0..workers.max(1) {
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
                halt,
            };
            scope.spawn(move || {
                while !halt.load(Ordering::Relaxed) {
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
    /// Ends the solve in flight.
    halt: &'a AtomicBool,
}

impl Worker<'_> {
    /// Climbs the retry ladder of one job until it is closed or the run halts.
    fn climb(&self, job: &Job, index: usize, tell: &dyn Fn(Message)) -> Result<(), CampaignError> {
        let mut record = job.record.clone();
        while let Some(rung) = record.as_ref().map_or(Some(Rung::AsAsked), |r| r.next) {
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
        let (solution, error) =
            match solve_window(&problem, self.tools, &work, self.limit, self.halt) {
                Ok(mut solution) => {
                    let error = solution.stopped.take();
                    (Some(solution), error)
                }
                Err(error) => (None, Some(error)),
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
        if let Some(solution) = &solution
            && let Some(last) = solution.samples.last()
            && last.lambda > record.lambda
        {
            record.rows_hash = job.folder.write_samples(&solution.samples)?;
            record.rows = solution.samples.len();
            record.lambda = last.lambda;
            record.tier = problem.tier;
        }
        record.next = failure
            .as_ref()
            .and_then(|(kind, _)| kind.next(rung, job.spec.problem.tier));
        (record.failure, record.message) = failure.unzip();
        record.attempts += 1;
        record.cpu_seconds += solution.and_then(|s| s.cpu_seconds).unwrap_or(0.0);
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
    path: PathBuf,
    events: File,
    start: Instant,
    closed_before: usize,
}

/// A line of `events.jsonl`.
#[derive(Serialize)]
struct Event<'a> {
    /// Seconds since 1970.
    time: u64,
    job: &'a str,
    rung: Rung,
    /// How the attempt ended; none when it starts.
    #[serde(skip_serializing_if = "Option::is_none")]
    ended: Option<&'a JobRecord>,
}

impl<'a> Books<'a> {
    fn open(folder: &CampaignFolder, jobs: &'a [Job]) -> Result<Self, FileError> {
        let path = folder.0.join("events.jsonl");
        let events = OpenOptions::new()
            .create(true)
            .append(true)
            .open(&path)
            .map_err(FileError::at(&path))?;
        let records: Vec<_> = jobs.iter().map(|job| job.record.clone()).collect();
        Ok(Self {
            jobs,
            closed_before: Tally::of(&records).closed(),
            records,
            path,
            events,
            start: Instant::now(),
        })
    }

    fn note(&mut self, message: Message) -> Result<(), CampaignError> {
        let (job, rung, record) = match message {
            Message::Started { job, rung } => (job, rung, None),
            Message::Ended { job, rung, record } => (job, rung, Some(record)),
            Message::Halted(error) => return Err(error),
        };
        let event = Event {
            time: now(),
            job: &self.jobs[job].id,
            rung,
            ended: record.as_ref(),
        };
        let mut line = serde_json::to_vec(&event).map_err(FileError::at(&self.path))?;
        line.push(b'\n');
        self.events
            .write_all(&line)
            .map_err(FileError::at(&self.path))?;
        if record.is_some() {
            self.records[job] = record;
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

/// Holds the folder against a second run until the file is dropped, however that comes about.
fn lock(folder: &Path) -> Result<File, CampaignError> {
    let path = folder.join("lock");
    let file = File::create(&path).map_err(FileError::at(&path))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(CampaignError::Locked(folder.to_owned())),
        Err(TryLockError::Error(source)) => Err(FileError::at(&path)(source).into()),
    }
}

/// Seconds since 1970.
fn now() -> u64 {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |since| since.as_secs())
}
