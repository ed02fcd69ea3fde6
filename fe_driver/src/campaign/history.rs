//! The history of a shard: an append-only file of events, locked by the process that writes it.

use crate::campaign::definition::CampaignError;
use crate::campaign::job::JobRecord;
use crate::record_file::FileError;
use crate::window::failure::RetryStep;
use serde::Serialize;
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};
use support::lock_file;

/// An event in the history of a job.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Event<'a> {
    Started {
        rung: RetryStep,
    },
    Ended {
        rung: RetryStep,
        record: &'a JobRecord,
    },
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

/// The open history of a shard. The shard stays locked until this value is dropped or the process exits.
#[derive(Debug)]
pub(crate) struct History {
    path: PathBuf,
    file: File,
}

impl History {
    /// Opens the history and locks it; an error if another process has locked it.
    pub fn open(path: &Path) -> Result<Self, CampaignError> {
        let held = lock_file::try_hold(path);
        let path = path.to_owned();
        match held {
            Ok(file) => Ok(Self { path, file }),
            Err(error) if error.kind() == ErrorKind::WouldBlock => Err(CampaignError::Locked(path)),
            Err(source) => Err(FileError { path, source }.into()),
        }
    }

    /// Appends an event of `job`.
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
    /// Unlocks the shard immediately. Without the explicit unlock, a solver process between fork and exec would share
    /// the open file and keep the lock.
    fn drop(&mut self) {
        // An error means that the file is no longer locked.
        let _ = self.file.unlock();
    }
}

/// Seconds since 1970.
pub(crate) fn now() -> u64 {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |since| since.as_secs())
}
