//! Running a campaign: the list of its solves, and a ledger of them.

use crate::{
    Campaign, CampaignError, CampaignFolder, Event, EventLog, Index, Job, Shard, SolveRecord,
    Solver, Tally, WindowSolve, Workers,
};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use support::file_error::FileError;

/// Which jobs a run works on, and how.
#[derive(Clone, Copy, Debug)]
pub struct RunOptions {
    /// The part of the jobs that the run works on.
    pub shard: Shard,
    /// Number of solves that run in parallel.
    pub workers: usize,
    /// No attempt is started after this time; attempts in flight are finished.
    pub time_limit: Option<Duration>,
    /// Closed jobs that failed are attempted from the beginning again. Their samples are kept until
    /// an attempt reaches a larger lambda.
    pub retry: bool,
}

/// The progress of a run.
#[derive(Clone, Debug)]
pub struct Progress {
    /// All jobs of the shard, including the jobs of earlier runs.
    pub tally: Tally,
    /// Estimated remaining time (s), from the rate of this run; `None` before it has closed a job.
    pub seconds_left: Option<f64>,
    /// The open jobs whose attempts in this run were ended by the machine, each with the last
    /// reason.
    pub disturbed: BTreeMap<String, String>,
}

/// Runs the open jobs of `campaign` in `folder`, and the failed jobs that have an attempt left.
/// `progress` is called at the start and after each event.
///
/// When `stop` becomes true, the solves in flight are terminated and the run returns its progress.
/// The next run continues from there.
pub fn run(
    campaign: &Campaign,
    folder: &Path,
    solver: &dyn Solver,
    options: &RunOptions,
    stop: &AtomicBool,
    progress: &mut dyn FnMut(&Progress),
) -> Result<Progress, CampaignError> {
    let workers = Workers {
        solver,
        count: options.workers,
        limit: campaign.time_limit,
        deadline: (options.time_limit).and_then(|limit| Instant::now().checked_add(limit)),
    };
    let folder = CampaignFolder(folder.to_owned());
    let solves: Vec<WindowSolve> = campaign.solves(&solver.versions()).collect();
    let index = Index::new(&campaign.name, &solves);
    let mut history = folder.enter(options.shard, &index)?;
    let store = folder.store();
    let jobs: Vec<Job> = (index.jobs.into_iter().zip(solves).enumerate())
        .filter(|(index, _)| options.shard.holds(*index))
        .map(|(_, (id, solve))| Job { folder: store.solve(&id), id, solve })
        .collect();
    for job in jobs.iter().filter(|_| options.retry) {
        if job.folder.reopen::<WindowSolve>(|_| true)? {
            history.note(&job.id, &Event::Reopened)?;
        }
    }
    let mut ledger = Ledger::new(history, &jobs)?;
    progress(&ledger.progress());
    workers.work_through(&jobs, stop, &mut |index, event| {
        let noted = ledger.note(index, event);
        progress(&ledger.progress());
        noted
    })?;
    Ok(ledger.progress())
}

/// The records of the jobs of a run, and its history on disk.
struct Ledger<'a> {
    jobs: &'a [Job],
    /// The current record of every job.
    records: Vec<Option<SolveRecord>>,
    /// [`Progress::disturbed`].
    disturbed: BTreeMap<String, String>,
    history: EventLog,
    start: Instant,
    closed_before: usize,
}

impl<'a> Ledger<'a> {
    fn new(history: EventLog, jobs: &'a [Job]) -> Result<Self, FileError> {
        let records = jobs.iter().map(|job| job.folder.ended::<WindowSolve>());
        let records = records.collect::<Result<Vec<_>, _>>()?;
        Ok(Self {
            jobs,
            closed_before: tally(jobs, &records).closed(),
            records,
            disturbed: BTreeMap::new(),
            history,
            start: Instant::now(),
        })
    }

    fn note(&mut self, index: usize, event: Event) -> Result<(), FileError> {
        let id = &self.jobs[index].id;
        if !matches!(event, Event::Found(_)) {
            self.history.note(id, &event)?;
        }
        match event {
            Event::Found(record) => self.records[index] = record,
            Event::Disturbed { reason, .. } => {
                self.disturbed.insert(id.clone(), reason);
            }
            Event::Ended { record, .. } => {
                self.disturbed.remove(id);
                self.records[index] = Some(record);
            }
            Event::Started { .. } | Event::Reopened | Event::Restored => {}
        }
        Ok(())
    }

    fn progress(&self) -> Progress {
        let tally = tally(self.jobs, &self.records);
        let closed = tally.closed() - self.closed_before;
        let pace = self.start.elapsed().as_secs_f64() / closed as f64;
        Progress {
            seconds_left: (closed > 0).then(|| pace * tally.to_run() as f64),
            tally,
            disturbed: self.disturbed.clone(),
        }
    }
}

/// The counts of jobs and their records.
fn tally(jobs: &[Job], records: &[Option<SolveRecord>]) -> Tally {
    Tally::new(std::iter::zip(jobs, records))
}
