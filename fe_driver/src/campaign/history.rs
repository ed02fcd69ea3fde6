//! The history of a shard: an append-only file of events, locked by the process that writes it.

use crate::{CampaignError, Event, Shard, now};
use serde_json::json;
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use support::file_error::FileError;
use support::{lock_file, refuse};

/// The open history of a shard. The shard stays locked until this value is dropped or the process
/// exits.
#[derive(Debug)]
pub(crate) struct EventLog {
    path: PathBuf,
    file: File,
}

impl EventLog {
    /// Opens the history and locks it; an error if another process has locked it.
    pub(crate) fn open(path: &Path) -> Result<Self, CampaignError> {
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
    pub(crate) fn note(&mut self, job: &str, event: &Event) -> Result<(), FileError> {
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
