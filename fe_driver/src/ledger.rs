//! The folder of a campaign, and how its jobs stand.
//!
//! `campaign.json` names the campaign and its jobs as last run, `jobs/<id>/` holds one job each,
//! `events.jsonl` is the append-only history.

use crate::campaign::{Campaign, CampaignError};
use crate::failure::FailureKind;
use crate::job::{FileError, JobFolder, JobRecord, read_json, write_json};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The folder of a campaign.
#[derive(Clone, Debug)]
pub(crate) struct CampaignFolder(pub PathBuf);

/// What `campaign.json` says.
#[derive(Serialize, Deserialize)]
pub(crate) struct Index {
    pub name: String,
    /// Ids of the jobs of the campaign as last run, in order.
    pub jobs: Vec<String>,
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
    pub fn belongs_to(&self, campaign: &Campaign) -> Result<(), CampaignError> {
        match read_json::<Index>(&self.index_path())? {
            Some(index) if index.name != campaign.name => Err(CampaignError::OtherCampaign {
                folder: self.0.clone(),
                found: index.name,
                asked: campaign.name.clone(),
            }),
            _ => Ok(()),
        }
    }

    pub fn write_index(&self, name: &str, jobs: Vec<String>) -> Result<(), FileError> {
        let name = name.to_owned();
        write_json(&self.index_path(), &Index { name, jobs })
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
        let entries = std::fs::read_dir(&path).map_err(FileError::at(&path))?;
        entries
            .map(|entry| {
                let entry = entry.map_err(FileError::at(&path))?;
                Ok(entry.file_name().to_string_lossy().into_owned())
            })
            .collect()
    }
}

/// How many jobs stand how.
#[derive(Clone, Debug, Default, PartialEq)]
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

    /// Jobs closed in an hour of one worker; `None` before the first.
    pub fn jobs_per_worker_hour(&self) -> Option<f64> {
        (self.closed() > 0).then(|| 3600.0 * self.closed() as f64 / self.wall_seconds)
    }
}

/// How a campaign stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Status {
    pub name: String,
    pub tally: Tally,
}

/// How the campaign in `folder` stands, as it was last run.
pub fn status(folder: &Path) -> Result<Status, CampaignError> {
    let folder = CampaignFolder(folder.to_owned());
    let Index { name, jobs } = folder.index()?;
    let tally = folder.tally(&jobs)?;
    Ok(Status { name, tally })
}
