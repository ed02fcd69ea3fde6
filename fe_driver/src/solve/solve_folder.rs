//! The store of solves on disk: one folder a solve, whole or open.
//!
//! The folder of a solve is `<first two digits of its id>/<id>/`, so that no folder has 10^5
//! entries. It contains `job.json` (all inputs of the result; its hash is the id), the file of the
//! samples (`rows.csv` for a window) and `result.json`. `result.json` is written last: a solve
//! without it is not done. These files are written atomically. Every process works in a folder of
//! its own, `work-<host>-<process>`. The deck and the log of the last attempt that failed remain in
//! `work`; the decks and logs of other attempts do not: the deck follows from `job.json`.

use crate::{
    AttemptKind, FailureKind, Solve, SolvedPath, WindowSolve, damaged, entries, read_json,
    unless_damaged,
};
use mesher::Tier;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use support::{FileError, processes, regular_file, sealed_json, whole_file};

/// The state of a solve after its last attempt.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SolveRecord {
    /// Why there are no samples, or only samples of a part of the path; `None` for a complete path.
    pub failure: Option<FailureKind>,
    /// The error message of the failure.
    pub message: Option<String>,
    /// The next attempt; `None` closes the solve.
    pub next: Option<AttemptKind>,
    /// Number of attempts.
    pub attempts: u32,
    /// Tier of the attempt that produced the samples.
    pub tier: Tier,
    /// Number of elements of its mesh.
    pub elements: usize,
    /// Number of samples, one per converged increment.
    pub rows: usize,
    /// Hash of the file of the samples.
    pub rows_hash: String,
    /// Lambda of the last sample; 1 for a complete path.
    pub lambda: f64,
    /// Newton iterations over all attempts.
    pub iterations: usize,
    /// Solver CPU time over all attempts (s), as far as the operating system reports it.
    pub cpu_seconds: f64,
    /// Wall time over all attempts (s).
    pub wall_seconds: f64,
    /// Wall time of the solver over all attempts that it ended by itself (s), a part of
    /// `wall_seconds`.
    pub solver_seconds: f64,
    /// Maximum resident memory of the solver (MiB), if the operating system reports it.
    pub peak_memory_mib: Option<f64>,
    /// Time at which the last attempt ended, in seconds since 1970.
    pub ended: u64,
}

impl SolveRecord {
    /// Whether no attempt is left.
    pub fn is_closed(&self) -> bool {
        self.next.is_none()
    }

    /// Whether it was solved in this folder, not restored from a database, which has no wall times.
    pub(crate) fn is_solved_here(&self) -> bool {
        self.wall_seconds > 0.0
    }
}

/// A record with the id of its solve: records do not change places unnoticed.
#[derive(Serialize, Deserialize)]
struct JobRecord<R> {
    job: String,
    #[serde(flatten)]
    record: R,
}

/// The state of a solve in its folder.
#[derive(Debug)]
pub(crate) enum SolveState<S: Solve = WindowSolve> {
    /// No attempt has ended; `started` if an attempt was started.
    Open { started: bool },
    /// An attempt has ended.
    Ended(Box<(S, SolveRecord)>),
    /// The files of the folder are damaged or inconsistent, with the reason. The solve counts as
    /// open: the next run solves it again.
    Damaged(String),
}

/// A folder of solves.
#[derive(Clone, Debug)]
pub struct SolveStore(pub PathBuf);

/// Number of digits in the name of a folder of solves.
const DIGITS: usize = 2;

impl SolveStore {
    /// The folder of a solve, which may not exist yet.
    pub fn solve(&self, id: &str) -> SolveFolder {
        let digits = id.get(..DIGITS).unwrap_or(id);
        SolveFolder(self.0.join(digits).join(id))
    }

    /// The ids of all solves that were ever started here.
    pub(crate) fn ids(&self) -> Result<BTreeSet<String>, FileError> {
        let mut ids = BTreeSet::new();
        for digits in folders(&self.0)? {
            ids.extend(folders(&self.0.join(digits))?);
        }
        Ok(ids)
    }
}

/// The names of the folders below a folder; none if it does not exist.
fn folders(folder: &Path) -> Result<Vec<String>, FileError> {
    if !folder.exists() {
        return Ok(Vec::new());
    }
    let entries = entries(folder)?.into_iter();
    let folders = entries.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_dir()));
    let names = folders.map(|entry| entry.file_name().to_string_lossy().into_owned());
    Ok(names.collect())
}

/// The folder of one solve.
#[derive(Debug)]
pub struct SolveFolder(pub PathBuf);

impl SolveFolder {
    /// The state of the solve. The consistency of its files is checked: the name of the folder must
    /// be the hash of `job.json`, and `result.json` contains the hash of the file of the samples.
    pub(crate) fn state<S: Solve>(&self) -> Result<SolveState<S>, FileError> {
        let flaw = |reason: &str| Ok(SolveState::Damaged(reason.to_owned()));
        let Some(solve) = unless_damaged(self.solve::<S>())? else {
            return flaw("job.json cannot be read");
        };
        let Some(record) = unless_damaged(self.record())? else {
            return flaw("result.json cannot be read, or belongs to another job");
        };
        if solve.as_ref().is_some_and(|solve| solve.id() != self.id()) {
            return flaw("job.json has changed: its hash is not the name of its folder");
        }
        match (solve, record) {
            (solve, None) => Ok(SolveState::Open { started: solve.is_some() }),
            (None, Some(_)) => flaw("job.json is missing"),
            (Some(solve), Some(record)) => {
                let name = S::Samples::FILE;
                if record.rows > 0 && !self.0.join(name).exists() {
                    return flaw(&format!("{name} is missing"));
                }
                if record.rows > 0 && unless_damaged(self.bytes(name, &record))?.is_none() {
                    return flaw(&format!("{name} does not match result.json"));
                }
                Ok(SolveState::Ended(Box::new((solve, record))))
            }
        }
    }

    /// Reads the inputs of the solve; `None` if it was never started.
    pub fn solve<S: Solve>(&self) -> Result<Option<S>, FileError> {
        read_json(&self.0.join("job.json"))
    }

    /// Reads the record of the solve; `None` before the first attempt has ended. It is an error if
    /// it is the record of another solve.
    pub fn record(&self) -> Result<Option<SolveRecord>, FileError> {
        let path = self.0.join(RECORD);
        match read_json::<JobRecord<SolveRecord>>(&path)? {
            Some(named) if named.job != self.id() => {
                let (other, hint) = (named.job, "delete it, and the next run solves this one");
                Err(damaged(&path, format!("it is the record of the solve {other}: {hint}")))
            }
            named => Ok(named.map(|named| named.record)),
        }
    }

    /// The id of the solve.
    fn id(&self) -> String {
        let name = self.0.file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    }

    /// Reads the samples; an error if their hash is not the one in `record`.
    pub fn samples<S: Solve>(&self, record: &SolveRecord) -> Result<S::Samples, FileError> {
        let name = S::Samples::FILE;
        let bytes = self.bytes(name, record)?;
        S::Samples::from_bytes(&bytes).map_err(FileError::at(&self.0.join(name)))
    }

    /// The bytes of the file of the samples, which must have the hash in `record`.
    fn bytes(&self, name: &str, record: &SolveRecord) -> Result<Vec<u8>, FileError> {
        let path = self.0.join(name);
        let bytes = regular_file::read(&path).map_err(FileError::at(&path))?;
        if blake3::hash(&bytes).to_hex().as_str() != record.rows_hash {
            let hint = "run the same command again";
            let what = format!("the rows do not match the hash in result.json: {hint}");
            return Err(damaged(&path, what));
        }
        Ok(bytes)
    }

    pub(crate) fn write_solve<S: Solve>(&self, solve: &S) -> Result<(), FileError> {
        whole_file::create_folder(&self.0).map_err(FileError::at(&self.0))?;
        sealed_json::write(&self.0.join("job.json"), solve)
    }

    /// Writes the samples so that every number is read back exactly; returns the hash of the file.
    pub(crate) fn write_samples<P: SolvedPath>(&self, samples: &P) -> Result<String, FileError> {
        let path = self.0.join(P::FILE);
        let bytes = samples.to_bytes().map_err(FileError::at(&path))?;
        whole_file::write(&path, &bytes).map_err(FileError::at(&path))?;
        Ok(blake3::hash(&bytes).to_hex().to_string())
    }

    pub(crate) fn write_record(&self, record: &SolveRecord) -> Result<(), FileError> {
        let job = self.id();
        sealed_json::write(&self.0.join(RECORD), &JobRecord { job, record })
    }

    /// The record of the solve if its files are consistent; `None` if no attempt has ended, or if
    /// the files are damaged.
    pub(crate) fn ended<S: Solve>(&self) -> Result<Option<SolveRecord>, FileError> {
        Ok(match self.state::<S>()? {
            SolveState::Ended(ended) => Some(ended.1),
            SolveState::Open { .. } | SolveState::Damaged(_) => None,
        })
    }

    /// Starts the attempts of a closed solve again if it failed in one of the ways that `may`
    /// accepts; returns whether it did. Its samples are kept until an attempt reaches a larger
    /// lambda.
    pub(crate) fn reopen<S: Solve>(
        &self,
        may: impl Fn(FailureKind) -> bool,
    ) -> Result<bool, FileError> {
        let Some(mut record) = self.ended::<S>()? else {
            return Ok(false);
        };
        let reopened = record.is_closed() && record.failure.is_some_and(may);
        if reopened {
            record.next = Some(AttemptKind::Requested);
            self.write_record(&record)?;
        }
        Ok(reopened)
    }

    /// The deck and the log of the last attempt that failed.
    pub fn work(&self) -> PathBuf {
        self.0.join(WORK)
    }

    /// The work folder of attempts of this process; another one may try the same solve at the same
    /// time.
    pub fn work_here(&self) -> PathBuf {
        let process = std::process::id();
        self.0.join(format!("{}{process}", work_prefix()))
    }

    /// Creates an empty work folder for an attempt, after removing those that killed processes of
    /// this host have left.
    pub(crate) fn fresh_work(&self) -> Result<PathBuf, FileError> {
        for entry in entries(&self.0)? {
            let name = entry.file_name().to_string_lossy().into_owned();
            let process = name.strip_prefix(&work_prefix()).map(str::parse);
            if let Some(Ok(process)) = process
                && !processes::is_running(process)
            {
                processes::kill_all_of(&entry.path());
                remove_folder(&entry.path())?;
            }
        }
        let work = self.work_here();
        remove_folder(&work)?;
        std::fs::create_dir_all(&work).map_err(FileError::at(&work))?;
        Ok(work)
    }

    /// Keeps the deck and the log of an attempt that has failed.
    pub(crate) fn keep_work(&self) -> Result<(), FileError> {
        let (from, to) = (self.work_here(), self.work());
        remove_folder(&to)?;
        match std::fs::rename(&from, &to) {
            // Another process has just kept the deck and the log of its own attempt at the same
            // solve.
            Err(error) if error.kind() == io::ErrorKind::DirectoryNotEmpty => remove_folder(&from),
            renamed => renamed.map_err(FileError::at(&to)),
        }
    }

    /// Removes what attempts of this process have left.
    pub(crate) fn remove_work(&self) -> Result<(), FileError> {
        remove_folder(&self.work())?;
        remove_folder(&self.work_here())
    }
}

/// Name of the record of a solve.
const RECORD: &str = "result.json";
/// Name of the folder with what remains of an attempt.
const WORK: &str = "work";

/// The name of the work folder of a process on this host, without the number of the process.
fn work_prefix() -> String {
    format!("{WORK}-{}-", host())
}

/// Removes a folder, if it is there.
fn remove_folder(folder: &Path) -> Result<(), FileError> {
    match std::fs::remove_dir_all(folder) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(FileError::at(folder)(error)),
        _ => Ok(()),
    }
}

/// The name of this host, by which the runs that share a folder are distinguished. `KIRIGAMI_HOST`
/// replaces it where host names are not unique.
pub(crate) fn host() -> String {
    let name = std::env::var_os("KIRIGAMI_HOST").or_else(|| nix::unistd::gethostname().ok());
    let name = name.unwrap_or_else(|| "localhost".into());
    name.to_string_lossy().replace('/', "_")
}

#[cfg(test)]
mod tests {
    use super::*;
    use hinge::HingeSample;
    use proptest::prelude::*;

    fn folder() -> (tempfile::TempDir, SolveFolder) {
        let root = tempfile::tempdir().unwrap();
        let folder = SolveFolder(root.path().to_owned());
        (root, folder)
    }

    proptest! {
        #[test]
        fn rows_are_read_back_bit_exactly(
            numbers in proptest::array::uniform4(proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL)
        ) {
            let [w, f_a, f_s, m_theta] = numbers;
            let rows = vec![HingeSample { w, f_a, f_s, m_theta, ..HingeSample::default() }; 2];
            let (_root, folder) = folder();
            let rows_hash = folder.write_samples(&rows).unwrap();
            let record = SolveRecord { rows_hash, ..SolveRecord::default() };
            prop_assert_eq!(folder.samples::<WindowSolve>(&record).unwrap(), rows);
        }
    }

    #[test]
    fn the_error_for_a_damaged_record_says_what_to_do() {
        let (_root, folder) = folder();
        assert!(folder.record().unwrap().is_none());
        folder.write_record(&SolveRecord::default()).unwrap();
        assert_eq!(folder.record().unwrap(), Some(SolveRecord::default()));
        let path = folder.0.join("result.json");
        std::fs::write(&path, "{\"failure\": nu").unwrap();
        let message = folder.record().unwrap_err().to_string();
        assert!(message.contains("result.json") && message.contains("delete it"), "{message}");
    }
}
