//! The folder of a campaign, and how its jobs stand.
//!
//! `campaign.json` names the campaign and its jobs as last run, `jobs/<id>/` holds one job each,
//! `events-<i>-of-<n>.jsonl` is the append-only history of each shard, and its lock.

use crate::campaign::{Campaign, CampaignError};
use crate::failure::FailureKind;
use crate::history::History;
use crate::job::{FileError, JobFolder, JobRecord, JobSpec, read_json, write_json};
use crate::shard::Shard;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::{DirEntry, File};
use std::path::{Path, PathBuf};

/// The folder of a campaign.
#[derive(Clone, Debug)]
pub(crate) struct CampaignFolder(pub PathBuf);

/// What `campaign.json` says.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Index {
    pub name: String,
    /// Ids of the jobs of the campaign as last run, in order.
    pub jobs: Vec<String>,
}

impl Index {
    pub fn of(name: &str, specs: &[JobSpec]) -> Self {
        Self {
            name: name.to_owned(),
            jobs: specs.iter().map(JobSpec::id).collect(),
        }
    }
}

impl CampaignFolder {
    pub fn job(&self, id: &str) -> JobFolder {
        JobFolder(self.0.join("jobs").join(id))
    }

    fn index_path(&self) -> PathBuf {
        self.0.join("campaign.json")
    }

    /// What `campaign.json` says.
    pub fn index(&self) -> Result<Index, CampaignError> {
        read_json(&self.index_path())?.ok_or_else(|| CampaignError::NoCampaign(self.0.clone()))
    }

    /// Refuses a folder that belongs to a campaign of another name.
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

    /// Makes the folder that of `index` and locks a shard of it, until the history is dropped.
    ///
    /// Refused while a shard that may overlap is at work.
    pub fn enter(&self, shard: Shard, index: &Index) -> Result<History, CampaignError> {
        std::fs::create_dir_all(&self.0).map_err(FileError::at(&self.0))?;
        // Shards that start together come in one by one: each would find the other's lock, and
        // they would write the index over each other.
        let door = self.0.join("lock");
        let _held = File::create(&door)
            .and_then(|file| file.lock().map(|()| file))
            .map_err(FileError::at(&door))?;
        self.belongs_to(&index.name)?;
        for entry in entries(&self.0)? {
            if shard.overlaps(&entry.file_name().to_string_lossy()) {
                History::open(&entry.path())?;
            }
        }
        write_json(&self.index_path(), index)?;
        History::open(&self.0.join(shard.history()))
    }

    /// How the jobs of these ids stand.
    pub fn tally<'a>(&self, ids: impl IntoIterator<Item = &'a String>) -> Result<Tally, FileError> {
        let records = ids.into_iter().map(|id| self.job(id).record());
        Ok(Tally::of(&records.collect::<Result<Vec<_>, _>>()?))
    }

    /// Ids of all jobs that were ever started here.
    pub fn ids(&self) -> Result<Vec<String>, FileError> {
        let path = self.0.join("jobs");
        if !path.exists() {
            return Ok(Vec::new());
        }
        let name = |entry: DirEntry| entry.file_name().to_string_lossy().into_owned();
        Ok(entries(&path)?.into_iter().map(name).collect())
    }
}

fn entries(folder: &Path) -> Result<Vec<DirEntry>, FileError> {
    std::fs::read_dir(folder)
        .and_then(Iterator::collect)
        .map_err(FileError::at(folder))
}

/// How many jobs stand how.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Tally {
    /// Never ended an attempt.
    pub open: usize,
    /// Failed, with something left to try.
    pub retry: usize,
    /// Solved to the end of the ray.
    pub complete: usize,
    /// Closed with samples that end before the ray does.
    pub partial: usize,
    /// Closed without samples.
    pub failed: usize,
    /// Samples of complete and partial jobs.
    pub rows: usize,
    /// Reasons of the last failure of partial, failed and retried jobs.
    pub failures: BTreeMap<FailureKind, usize>,
    /// Of the solver, over all attempts (s).
    pub cpu_seconds: f64,
    /// Of one worker, over all attempts (s).
    pub wall_seconds: f64,
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
    }

    /// Jobs that nothing more will be done to.
    pub fn closed(&self) -> usize {
        self.complete + self.partial + self.failed
    }

    /// Jobs that a run would work on.
    pub fn to_run(&self) -> usize {
        self.open + self.retry
    }

    /// The pace so far; `None` before there are samples.
    fn throughput(&self) -> Option<Throughput> {
        (self.rows > 0).then(|| Throughput {
            rays_per_hour: 3600.0 * self.closed() as f64 / self.wall_seconds,
            samples_per_hour: 3600.0 * self.rows as f64 / self.wall_seconds,
            cpu_seconds_per_sample: self.cpu_seconds / self.rows as f64,
            overhead: 1.0 - self.cpu_seconds / self.wall_seconds,
        })
    }
}

/// The pace of one worker over all attempts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Throughput {
    /// Jobs closed in an hour.
    pub rays_per_hour: f64,
    pub samples_per_hour: f64,
    /// Of the solver, over all attempts.
    pub cpu_seconds_per_sample: f64,
    /// Share of the time that the solver did not compute: gmsh, reading and writing, waiting for
    /// a processor.
    pub overhead: f64,
}

/// How a campaign stands.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Status {
    pub name: String,
    pub tally: Tally,
    pub throughput: Option<Throughput>,
}

/// Refuses a folder in which `campaign` was last run with other settings than it has now.
///
/// Tool versions are those of the folder: neither gmsh nor ccx need be installed.
pub fn refuse_changed(campaign: &Campaign, folder: &Path) -> Result<(), CampaignError> {
    let folder = CampaignFolder(folder.to_owned());
    folder.belongs_to(&campaign.name)?;
    let ids = folder.index()?.jobs;
    let mut specs = ids.iter().map(|id| folder.job(id).spec());
    let Some(solved) = specs.find_map(Result::transpose).transpose()? else {
        return Ok(());
    };
    let asked = campaign.jobs(&solved.tools);
    if Index::of(&campaign.name, &asked).jobs == ids {
        return Ok(());
    }
    let changes = asked
        .first()
        .map_or(Vec::new(), |first| first.differences(&solved));
    Err(CampaignError::Changed {
        folder: folder.0,
        changes: match changes.as_slice() {
            [] => "its rays".into(),
            changes => changes.join(", "),
        },
    })
}

/// How the campaign in `folder` stands, as it was last run.
pub fn status(folder: &Path) -> Result<Status, CampaignError> {
    let folder = CampaignFolder(folder.to_owned());
    let Index { name, jobs } = folder.index()?;
    let tally = folder.tally(&jobs)?;
    Ok(Status {
        name,
        throughput: tally.throughput(),
        tally,
    })
}
