//! The history of a shard: an append-only file of events, locked by who writes it.

use crate::campaign::CampaignError;
use crate::failure::Rung;
use crate::job::{FileError, JobRecord};
use serde::Serialize;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// What happened to a job.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Event<'a> {
    Started { rung: Rung },
    Ended { rung: Rung, record: &'a JobRecord },
    Reopened,
    Restored,
}

/// A line of the history.
#[derive(Serialize)]
struct Line<'a> {
    /// Seconds since 1970.
    time: u64,
    job: &'a str,
    event: Event<'a>,
}

/// The open history of a shard; the shard is locked until it is dropped, however that comes about.
#[derive(Debug)]
pub(crate) struct History {
    path: PathBuf,
    file: File,
}

impl History {
    /// Opens the history and locks it, unless somebody else has.
    pub fn open(path: &Path) -> Result<Self, CampaignError> {
        let file = OpenOptions::new()
            .create(true)
            .append(true)
            .open(path)
            .map_err(FileError::at(path))?;
        let path = path.to_owned();
        match file.try_lock() {
            Ok(()) => Ok(Self { path, file }),
            Err(TryLockError::WouldBlock) => Err(CampaignError::Locked(path)),
            Err(TryLockError::Error(source)) => Err(FileError { path, source }.into()),
        }
    }

    /// Appends what happened to `job`.
    pub fn note(&mut self, job: &str, event: Event) -> Result<(), FileError> {
        let time = now();
        let mut line =
            serde_json::to_vec(&Line { time, job, event }).map_err(FileError::at(&self.path))?;
        line.push(b'\n');
        self.file
            .write_all(&line)
            .map_err(FileError::at(&self.path))
    }
}

impl Drop for History {
    /// Gives the shard free at once: a solver that is just being started shares the open file, and
    /// with it the lock, until it has become another program.
    fn drop(&mut self) {
        // An error means that it is not locked any more.
        let _ = self.file.unlock();
    }
}

/// Seconds since 1970.
pub(crate) fn now() -> u64 {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |since| since.as_secs())
}
