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
    CampaignError, EventLog, Shard, Solve, SolveStore, Solved, ToolVersions, WindowSolve, entries,
    history_name, host, overlaps, read_json, write_json,
};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use support::file_error::FileError;
use support::{fault, lock_file, refuse, whole_file};

/// The folder of a campaign.
#[derive(Clone, Debug)]
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
    pub(crate) fn index(&self) -> Result<Index, CampaignError> {
        let index = read_json(&self.index_path())?;
        Ok(index.ok_or_else(|| {
            fault!("{} contains no campaign: run a campaign there first", self.0.display())
        })?)
    }

    /// Reads `campaign.json` if it exists; an error if it is of a campaign with another name.
    pub(crate) fn known(&self, name: &str) -> Result<Option<Index>, CampaignError> {
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
    pub(crate) fn enter(&self, shard: Shard, index: &Index) -> Result<EventLog, CampaignError> {
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
        write_json(&self.index_path(), index)?;
        EventLog::open(&home.join(history_name(shard)))
    }
}

/// The solves of the campaign in `folder` that are closed and have samples, in the order of their
/// ids, as in a database.
///
/// Stale jobs are omitted. Neither gmsh nor ccx needs to be installed.
pub fn finished_windows(
    folder: &Path,
) -> Result<impl Iterator<Item = Result<Solved, FileError>>, CampaignError> {
    let folder = CampaignFolder(folder.to_owned());
    let mut ids = folder.index()?.jobs;
    ids.sort_unstable();
    let store = folder.store();
    let windows = ids.into_iter().map(move |id| store.solve(&id).result());
    let has_samples = |window: &Solved| !window.samples.is_empty();
    Ok(windows.filter_map(move |window| window.map(|found| found.filter(has_samples)).transpose()))
}
