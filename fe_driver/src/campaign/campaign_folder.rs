//! The folder of a campaign.
//!
//! `campaign.json` contains the name of the campaign, the versions of gmsh and ccx, and the ids of
//! its jobs as last run. `jobs/` is the store of their solves. `hosts/<host>/` contains what only
//! the runs on one host write: the append-only history `events-<i>-of-<n>.jsonl` of each shard,
//! which is also its lock file.
//!
//! Hosts may share the folder, also on a file system whose locks do not work across hosts: locks
//! only prevent that two runs on one host do the same work. Runs on different hosts may solve the
//! same job twice; it is counted once.

use crate::{
    Solve, SolveEvent, SolveListError, SolveStore, Solved, ToolVersions, WindowSolve, entries,
    host, now, read_json,
};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use support::{Fault, FileError, fault, lock_file, refuse, sealed_json, whole_file};

/// The folder of a campaign.
#[derive(Debug)]
pub(crate) struct CampaignFolder(pub PathBuf);

/// The contents of `campaign.json`.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Index {
    pub name: String,
    /// Versions of the programs that solve the jobs; `None` without a job.
    pub tools: Option<ToolVersions>,
    /// Ids of the jobs of the campaign as last run, in order.
    pub jobs: Vec<String>,
}

impl Index {
    pub(crate) fn new(name: &str, solves: &[WindowSolve]) -> Self {
        Self {
            name: name.to_owned(),
            tools: solves.first().map(|solve| solve.tools.clone()),
            jobs: solves.iter().map(WindowSolve::id).collect(),
        }
    }
}

impl CampaignFolder {
    /// The solves of the jobs.
    pub(crate) fn store(&self) -> SolveStore {
        SolveStore(self.0.join("jobs"))
    }

    fn index_path(&self) -> PathBuf {
        self.0.join("campaign.json")
    }

    /// Reads `campaign.json`.
    pub(crate) fn index(&self) -> Result<Index, SolveListError> {
        let index = read_json(&self.index_path())?;
        Ok(index.ok_or_else(|| {
            fault!("{} contains no campaign: run a campaign there first", self.0.display())
        })?)
    }

    /// Reads `campaign.json` if it exists; an error if it is of a campaign with another name.
    pub(crate) fn known(&self, name: &str) -> Result<Option<Index>, SolveListError> {
        match read_json::<Index>(&self.index_path())? {
            Some(Index { name: found, .. }) if found != name => refuse!(
                "{} contains the campaign `{found}`, not `{name}`: choose another folder",
                self.0.display()
            ),
            known => Ok(known),
        }
    }

    /// Writes `index` to the folder and locks one shard of it on this host until the returned
    /// history is dropped.
    ///
    /// It is an error if a shard that may overlap with this one is locked on this host, or if this
    /// is a part of a campaign whose other parts are solved with other versions of gmsh and ccx.
    pub(crate) fn enter(&self, shard: Shard, index: &Index) -> Result<EventLog, SolveListError> {
        let home = self.0.join("hosts").join(host());
        whole_file::create_folder(&home).map_err(FileError::at(&home))?;
        // Shards that start at the same time enter one after the other. Otherwise each would find
        // the lock of the other.
        let door = home.join("lock");
        let _held = lock_file::hold(&door).map_err(FileError::at(&door))?;
        let known = self.known(&index.name)?.and_then(|known| known.tools);
        // Only the rows of one pair of versions are collected.
        if shard != Shard::WHOLE
            && let (Some(known), Some(here)) = (known, &index.tools)
            && known != *here
        {
            let (host, index) = (host(), self.index_path());
            let index = index.display();
            Err(fault!(
                "{host} has {here}, but the campaign is solved with {known}: rows of different versions are not \
                 collected together. Use the same versions on every host; or delete {index}, and all rays are \
                 solved again with the versions of the next run (no file of a job is lost)"
            ))?;
        }
        for entry in entries(&home)? {
            if overlaps(shard, &entry.file_name().to_string_lossy()) {
                EventLog::open(&entry.path())?;
            }
        }
        sealed_json::write(&self.index_path(), index)?;
        EventLog::open(&home.join(history_name(shard)))
    }
}

/// The solves of the campaign in `folder` that are closed and have samples, in the order of their
/// ids, as in a database.
///
/// Stale jobs are omitted. Neither gmsh nor ccx needs to be installed.
pub fn finished_windows(
    folder: &Path,
) -> Result<impl Iterator<Item = Result<Solved, FileError>>, SolveListError> {
    let folder = CampaignFolder(folder.to_owned());
    let mut ids = folder.index()?.jobs;
    ids.sort_unstable();
    let store = folder.store();
    let windows = ids.into_iter().map(move |id| store.solve(&id).result());
    let has_samples = |window: &Solved| !window.samples.is_empty();
    Ok(windows.filter_map(move |window| window.map(|found| found.filter(has_samples)).transpose()))
}

// A shard: every n-th of a list of jobs.
//
// The shards of one list may run at the same time, on one machine or on several machines that
// share the folder. Together they do the same jobs as one run of the whole list.

/// The part of the jobs that one run works on; written `2/4` for the second of four.
#[derive(Clone, Copy, Debug, PartialEq, derive_more::Display)]
#[display("{index}/{count}")]
pub struct Shard {
    /// Number of the shard, 1 to `count`.
    index: usize,
    count: usize,
}

impl Shard {
    /// All jobs.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// Whether the job at an index of the list belongs to the shard.
    pub fn holds(self, job: usize) -> bool {
        job % self.count == self.index - 1
    }
}

impl FromStr for Shard {
    type Err = Fault;

    fn from_str(text: &str) -> Result<Self, Fault> {
        let parse = || {
            let (index, count) = text.split_once('/')?;
            let (index, count) = (index.parse().ok()?, count.parse().ok()?);
            (1..=count).contains(&index).then_some(Self { index, count })
        };
        parse().ok_or_else(|| {
            fault!("`{text}` is not a shard: write i/n with 1 <= i <= n, for example 2/4")
        })
    }
}

// The history of a shard: an append-only file of events, locked by the process that writes it.

/// The open history of a shard. The shard stays locked until this value is dropped or the process
/// exits.
#[derive(Debug)]
pub(crate) struct EventLog {
    path: PathBuf,
    file: File,
}

impl EventLog {
    /// Opens the history and locks it; an error if another process has locked it.
    pub(crate) fn open(path: &Path) -> Result<Self, SolveListError> {
        let held = lock_file::try_hold(path);
        let path = path.to_owned();
        match held {
            Ok(file) => Ok(Self { path, file }),
            Err(error) if error.kind() == ErrorKind::WouldBlock => {
                refuse!("another run has locked {}: wait until it ends, or stop it", path.display())
            }
            Err(source) => Err(FileError { path, source }.into()),
        }
    }

    /// Appends an event of `job`.
    pub(crate) fn note(&mut self, job: &str, event: &SolveEvent) -> Result<(), FileError> {
        let line = json!({ "time": now(), "job": job, "event": event });
        self.file.write_all(format!("{line}\n").as_bytes()).map_err(FileError::at(&self.path))
    }
}

impl Drop for EventLog {
    /// Unlocks the shard immediately. Without the explicit unlock, a solver process between fork
    /// and exec would share the open file and keep the lock.
    fn drop(&mut self) {
        // An error means that the file is no longer locked.
        let _ = self.file.unlock();
    }
}

/// File name prefix of the histories.
const HISTORY: &str = "events-";

/// File name of the shard's history in the folder of the campaign.
pub(crate) fn history_name(shard: Shard) -> String {
    format!("{HISTORY}{}.jsonl", shard.to_string().replace('/', "-of-"))
}

/// Whether a file is the history of a shard that may overlap with this one: of this shard itself,
/// or of a division into another number of shards.
pub(crate) fn overlaps(shard: Shard, file_name: &str) -> bool {
    let own = history_name(shard);
    // The end of the names of all shards of the same division.
    let siblings = own.find("-of-").map_or("", |at| &own[at..]);
    file_name.starts_with(HISTORY) && (!file_name.ends_with(siblings) || file_name == own)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_job_is_in_exactly_one_shard() {
        let shards = ["1/3", "2/3", "3/3"].map(|text| text.parse::<Shard>().unwrap());
        for index in 0..10 {
            assert!(Shard::WHOLE.holds(index));
            assert_eq!(shards.iter().filter(|s| s.holds(index)).count(), 1);
        }
    }

    #[test]
    fn invalid_shards_are_rejected() {
        for text in ["", "1", "0/2", "3/2", "-1/2", "1/0", "1/2/3", "a/b"] {
            let message = text.parse::<Shard>().unwrap_err().to_string();
            assert!(message.contains("i/n"), "{message}");
        }
    }
}

#[cfg(test)]
mod history_tests {
    use super::*;

    #[test]
    fn a_shard_overlaps_itself_and_every_other_division() {
        let shard: Shard = "2/4".parse().unwrap();
        for (history, expected) in [
            ("events-2-of-4.jsonl", true),
            ("events-1-of-1.jsonl", true),
            ("events-2-of-14.jsonl", true),
            ("events-1-of-4.jsonl", false),
            ("campaign.json", false),
        ] {
            assert_eq!(overlaps(shard, history), expected, "{history}");
        }
    }
}
