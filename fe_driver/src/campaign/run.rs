//! Running a campaign: the list of its solves, and a ledger of them.

use crate::{
    Campaign, CampaignFolder, EventLog, Index, Job, Shard, SolveEvent, SolveListError, SolveRecord,
    SolvedRay, Solver, Tally, ToolVersions, WindowSolve, Workers, now,
};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use support::{FileError, refuse};

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
#[derive(Debug)]
pub struct CampaignProgress {
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
    progress: &mut dyn FnMut(&CampaignProgress),
) -> Result<CampaignProgress, SolveListError> {
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
            history.note(&job.id, &SolveEvent::Reopened)?;
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
    /// [`CampaignProgress::disturbed`].
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

    fn note(&mut self, index: usize, event: SolveEvent) -> Result<(), FileError> {
        let id = &self.jobs[index].id;
        if !matches!(event, SolveEvent::Found(_)) {
            self.history.note(id, &event)?;
        }
        match event {
            SolveEvent::Found(record) => self.records[index] = record,
            SolveEvent::Disturbed { reason, .. } => {
                self.disturbed.insert(id.clone(), reason);
            }
            SolveEvent::Ended { record, .. } => {
                self.disturbed.remove(id);
                self.records[index] = Some(record);
            }
            SolveEvent::Started { .. } | SolveEvent::Reopened | SolveEvent::Restored => {}
        }
        Ok(())
    }

    fn progress(&self) -> CampaignProgress {
        let tally = tally(self.jobs, &self.records);
        let closed = tally.closed() - self.closed_before;
        let pace = self.start.elapsed().as_secs_f64() / closed as f64;
        CampaignProgress {
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

// Recreates job folders from collected samples, so that collected jobs are not solved again.

/// Numbers of jobs that were restored, already present, and foreign.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Restored {
    /// Jobs that were restored.
    pub written: usize,
    /// Jobs that are already closed in the folder; they are not changed.
    pub there: usize,
    /// Jobs that do not belong to the campaign.
    pub foreign: usize,
}

/// Recreates the folders of jobs that `campaign` finished in another place or earlier.
///
/// The id of a job is a hash of all inputs of its result. Jobs of another campaign are omitted; it
/// is an error if all jobs are of another campaign.
pub fn restore(
    campaign: &Campaign,
    folder: &Path,
    collected: &[SolvedRay],
) -> Result<Restored, SolveListError> {
    let mut restored = Restored::default();
    let Some(first) = collected.first() else {
        return Ok(restored);
    };
    // Jobs of another campaign may have been solved with other versions of gmsh and ccx.
    let mut tools: Vec<&ToolVersions> = collected.iter().map(|ray| &ray.tools).collect();
    tools.dedup();
    let solves_with = |tools| {
        let solves: Vec<WindowSolve> = campaign.solves(tools).collect();
        let index = Index::new(&campaign.name, &solves);
        let ids: HashSet<&String> = index.jobs.iter().collect();
        let known = collected.iter().any(|ray| ids.contains(&ray.job));
        known.then_some((index, solves))
    };
    let Some((index, solves)) = tools.into_iter().find_map(solves_with) else {
        refuse!(
            "none of the jobs belongs to the campaign (the first is {}): they were solved with other settings, with another \
     version of gmsh or ccx, or for another campaign",
            first.job
        );
    };
    let solves: HashMap<_, _> = index.jobs.iter().zip(solves).collect();
    let folder = CampaignFolder(folder.to_owned());
    let (store, mut history) = (folder.store(), folder.enter(Shard::WHOLE, &index)?);
    for ray in collected {
        let Some(solve) = solves.get(&ray.job) else {
            restored.foreign += 1;
            continue;
        };
        let home = store.solve(&ray.job);
        if home.ended::<WindowSolve>()?.is_some_and(|record| record.is_closed()) {
            restored.there += 1;
            continue;
        }
        home.write_solve(solve)?;
        let rows_hash = home.write_samples(&ray.samples)?;
        home.write_record(&record(ray, rows_hash))?;
        history.note(&ray.job, &SolveEvent::Restored)?;
        restored.written += 1;
    }
    Ok(restored)
}

/// The record of a solve that was made elsewhere. The database does not contain its wall time.
fn record(ray: &SolvedRay, rows_hash: String) -> SolveRecord {
    SolveRecord {
        failure: ray.failure,
        message: (ray.failure).map(|_| "restored from a database".to_owned()),
        attempts: 1,
        tier: ray.solved_tier,
        rows: ray.samples.len(),
        rows_hash,
        lambda: ray.samples.last().map_or(0.0, |last| last.lambda),
        cpu_seconds: ray.cpu_s,
        ended: now(),
        ..SolveRecord::default()
    }
}
