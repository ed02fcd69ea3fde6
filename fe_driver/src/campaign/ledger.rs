//! The folder of a campaign, and the state of its jobs.
//!
//! `campaign.json` contains the name of the campaign, the versions of gmsh and ccx, and the ids of its jobs as last
//! run. `jobs/<2 digits>/<id>/` contains one job. `hosts/<host>/` contains what only the runs on one host write: the append-only
//! history `events-<i>-of-<n>.jsonl` of each shard, which is also its lock file.
//!
//! Hosts may share the folder, also on a file system whose locks do not work across hosts: locks only prevent that
//! two runs on one host do the same work. Runs on different hosts may solve the same job twice; it is counted once.

use crate::campaign::definition::{Campaign, CampaignError};
use crate::campaign::history::History;
use crate::campaign::host::host;
use crate::campaign::job::{JobFolder, JobRecord, JobSpec, JobState};
use crate::campaign::job_folders::{gather, ids, job_folder};
use crate::campaign::shard_history::{history_name, overlaps};
use crate::record_file::{FileError, entries, read_json, write_json};
use crate::window::failure::FailureKind;
use crate::window::versions::ToolVersions;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use support::shard::Shard;
use support::{lock_file, whole_file};

/// The folder of a campaign.
#[derive(Clone, Debug)]
pub(crate) struct CampaignFolder(pub PathBuf);

/// The contents of `campaign.json`.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Index {
    pub name: String,
    /// Versions of the programs that solve the jobs; `None` in folders of earlier versions.
    #[serde(default)]
    pub tools: Option<ToolVersions>,
    /// Ids of the jobs of the campaign as last run, in order.
    pub jobs: Vec<String>,
}

impl Index {
    pub fn of(name: &str, specs: &[JobSpec]) -> Self {
        Self {
            name: name.to_owned(),
            tools: specs.first().map(|spec| spec.tools.clone()),
            jobs: specs.iter().map(JobSpec::id).collect(),
        }
    }
}

impl CampaignFolder {
    pub fn job(&self, id: &str) -> JobFolder {
        job_folder(&self.jobs(), id)
    }

    fn jobs(&self) -> PathBuf {
        self.0.join("jobs")
    }

    fn index_path(&self) -> PathBuf {
        self.0.join("campaign.json")
    }

    /// Reads `campaign.json`.
    pub fn index(&self) -> Result<Index, CampaignError> {
        read_json(&self.index_path())?.ok_or_else(|| CampaignError::NoCampaign(self.0.clone()))
    }

    /// Rejects a folder that belongs to a campaign with another name.
    pub fn belongs_to(&self, name: &str) -> Result<(), CampaignError> {
        match read_json::<Index>(&self.index_path())? {
            Some(index) if index.name != name => Err(CampaignError::OtherCampaign {
                folder: self.0.clone(),
                found: index.name,
                asked: name.to_owned(),
            }),
            _ => Ok(()),
        }
    }

    /// Writes `index` to the folder and locks one shard of it on this host until the returned history is dropped.
    ///
    /// It is an error if a shard that may overlap with this one is locked on this host, or if this is a part of a
    /// campaign whose other parts are solved with other versions of gmsh and ccx.
    pub fn enter(&self, shard: Shard, index: &Index) -> Result<History, CampaignError> {
        let home = self.0.join("hosts").join(host());
        whole_file::create_folder(&home).map_err(FileError::at(&home))?;
        // Shards that start at the same time enter one after the other. Otherwise each would find the lock of the
        // other.
        let door = home.join("lock");
        let _held = lock_file::hold(&door).map_err(FileError::at(&door))?;
        self.belongs_to(&index.name)?;
        if shard != Shard::WHOLE {
            self.refuse_other_versions(index)?;
        }
        for entry in entries(&home)? {
            if overlaps(shard, &entry.file_name().to_string_lossy()) {
                History::open(&entry.path())?;
            }
        }
        gather(&self.jobs())?;
        write_json(&self.index_path(), index)?;
        History::open(&home.join(history_name(shard)))
    }

    /// Rejects versions of gmsh and ccx other than those with which the campaign was last run. Only the rows of one
    /// pair of versions are collected.
    fn refuse_other_versions(&self, index: &Index) -> Result<(), CampaignError> {
        let known = read_json::<Index>(&self.index_path())?.and_then(|known| known.tools);
        match (known, &index.tools) {
            (Some(known), Some(here)) if known != *here => Err(CampaignError::OtherVersions {
                index: self.index_path(),
                host: host(),
                here: Box::new(here.clone()),
                known: Box::new(known),
            }),
            _ => Ok(()),
        }
    }

    /// Ids of all jobs that were ever started here.
    pub fn ids(&self) -> Result<BTreeSet<String>, FileError> {
        ids(&self.jobs())
    }
}

/// Numbers of jobs in each state, with their total cost.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Tally {
    /// Jobs without a completed attempt.
    pub open: usize,
    /// Open jobs whose files are damaged: the next run solves them again.
    pub damaged: usize,
    /// Failed jobs with a retry left.
    pub retry: usize,
    /// Jobs solved to the end of the ray.
    pub complete: usize,
    /// Closed jobs whose samples end before the end of the ray.
    pub partial: usize,
    /// Closed jobs without samples.
    pub failed: usize,
    /// Samples of complete and partial jobs.
    pub rows: usize,
    /// Kinds of the last failure of partial, failed and retried jobs.
    pub failures: BTreeMap<FailureKind, usize>,
    /// Solver CPU time over all attempts (s).
    pub cpu_seconds: f64,
    /// Wall time of one worker over all attempts (s); restored jobs have none.
    pub wall_seconds: f64,
    /// Closed jobs that were solved in this folder, not restored. The throughput is that of these jobs.
    pub solved_here: usize,
    /// Closed jobs whose time is known: the wall time of those solved here, the CPU time of restored ones.
    pub timed: usize,
    #[serde(skip)]
    timed_seconds: f64,
    #[serde(skip)]
    rows_solved_here: usize,
    #[serde(skip)]
    cpu_seconds_here: f64,
}

impl Tally {
    /// Counts the jobs with these records; a job without one is open.
    pub(crate) fn of<'a>(records: impl IntoIterator<Item = &'a Option<JobRecord>>) -> Self {
        let mut tally = Self::default();
        for record in records {
            match record {
                Some(record) => tally.add(record),
                None => tally.open += 1,
            }
        }
        tally
    }

    /// Counts a job in this state.
    pub(crate) fn add_state(&mut self, state: &JobState) {
        match state {
            JobState::Open { .. } => self.open += 1,
            JobState::Ended(ended) => self.add(&ended.1),
            JobState::Damaged(_) => {
                self.open += 1;
                self.damaged += 1;
            }
        }
    }

    fn add(&mut self, record: &JobRecord) {
        *match (record.is_closed(), record.failure, record.rows) {
            (false, ..) => &mut self.retry,
            (true, None, _) => &mut self.complete,
            (true, Some(_), 0) => &mut self.failed,
            (true, Some(_), _) => &mut self.partial,
        } += 1;
        if record.is_closed() {
            self.rows += record.rows;
        }
        if let Some(kind) = record.failure {
            *self.failures.entry(kind).or_default() += 1;
        }
        self.cpu_seconds += record.cpu_seconds;
        self.wall_seconds += record.wall_seconds;
        let seconds = match record.is_solved_here() {
            true => record.wall_seconds,
            false => record.cpu_seconds,
        };
        if seconds > 0.0 {
            self.timed_seconds += seconds;
            self.timed += usize::from(record.is_closed());
        }
        if record.is_solved_here() {
            self.cpu_seconds_here += record.cpu_seconds;
            if record.is_closed() {
                self.solved_here += 1;
                self.rows_solved_here += record.rows;
            }
        }
    }

    /// Number of closed jobs.
    pub fn closed(&self) -> usize {
        self.complete + self.partial + self.failed
    }

    /// Number of jobs that a run would work on.
    pub fn to_run(&self) -> usize {
        self.open + self.retry
    }

    /// Time of one worker per job (s); `None` before a job of known time is closed.
    pub(crate) fn seconds_a_job(&self) -> Option<f64> {
        (self.timed > 0).then(|| self.timed_seconds / self.timed as f64)
    }

    /// The throughput so far; `None` before there are samples of jobs solved in this folder.
    fn throughput(&self) -> Option<Throughput> {
        let hours = self.wall_seconds / 3600.0;
        (self.rows_solved_here > 0).then(|| Throughput {
            rays_per_hour: self.solved_here as f64 / hours,
            samples_per_hour: self.rows_solved_here as f64 / hours,
            cpu_seconds_per_sample: self.cpu_seconds_here / self.rows_solved_here as f64,
            overhead: 1.0 - self.cpu_seconds_here / self.wall_seconds,
        })
    }
}

/// The throughput of one worker over all attempts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Throughput {
    /// Closed jobs per hour.
    pub rays_per_hour: f64,
    /// Samples of closed jobs per hour.
    pub samples_per_hour: f64,
    /// Solver CPU time over all attempts, per sample (s).
    pub cpu_seconds_per_sample: f64,
    /// Fraction of the wall time in which the solver did not compute: gmsh, reading and writing, waiting for
    /// a processor.
    pub overhead: f64,
}

/// The state of a campaign.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Status {
    /// Name of the campaign.
    pub name: String,
    /// Numbers of jobs by their state.
    pub tally: Tally,
    /// The throughput so far; `None` before a job solved in this folder has samples.
    pub throughput: Option<Throughput>,
}

/// Rejects a folder in which `campaign` was last run with settings other than its current ones.
///
/// Tool versions are taken from the folder: neither gmsh nor ccx needs to be installed.
pub fn refuse_changed(campaign: &Campaign, folder: &Path) -> Result<(), CampaignError> {
    let folder = CampaignFolder(folder.to_owned());
    folder.belongs_to(&campaign.name)?;
    let ids = folder.index()?.jobs;
    let mut specs = ids.iter().map(|id| folder.job(id).spec());
    let Some(solved) = specs.find_map(Result::transpose).transpose()? else {
        return Ok(());
    };
    let asked = || campaign.specs(&solved.tools);
    if asked().map(|spec| spec.id()).eq(ids) {
        return Ok(());
    }
    let changes = asked()
        .next()
        .map_or(Vec::new(), |first| first.differences(&solved));
    Err(CampaignError::Changed {
        folder: folder.0,
        changes: match changes.as_slice() {
            [] => "its rays".into(),
            changes => changes.join(", "),
        },
    })
}

/// The state of the campaign in `folder`, as it was last run.
pub fn status(folder: &Path) -> Result<Status, CampaignError> {
    let folder = CampaignFolder(folder.to_owned());
    let Index { name, jobs, .. } = folder.index()?;
    let mut tally = Tally::default();
    for id in jobs {
        tally.add_state(&folder.job(&id).state()?);
    }
    Ok(Status {
        name,
        throughput: tally.throughput(),
        tally,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solved(cpu_seconds: f64, wall_seconds: f64) -> Option<JobRecord> {
        Some(JobRecord {
            rows: 20,
            cpu_seconds,
            wall_seconds,
            ..JobRecord::default()
        })
    }

    /// Restored jobs have no wall time, but their CPU time is that of the material.
    #[test]
    fn the_time_of_a_job_is_also_that_of_restored_ones() {
        assert_eq!(Tally::of(&[None]).seconds_a_job(), None);
        let restored = Tally::of(&[solved(60.0, 0.0), solved(80.0, 0.0), None]);
        assert_eq!((restored.timed, restored.seconds_a_job()), (2, Some(70.0)));
        assert_eq!((restored.solved_here, restored.throughput()), (0, None));
        let mixed = Tally::of(&[solved(60.0, 0.0), solved(75.0, 80.0), None]);
        assert_eq!((mixed.timed, mixed.seconds_a_job()), (2, Some(70.0)));
    }
}
