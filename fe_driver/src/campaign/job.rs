//! One job of a campaign: its identity and its folder.
//!
//! The id is a hash of all inputs of the result. The folder contains `job.json` (the inputs), `rows.csv` (the
//! samples) and `result.json`. `result.json` is written last: a job without it is not done. These files are written
//! atomically. Deck and log of an attempt remain only if it failed: the deck follows from `job.json`.

use crate::campaign::host::host;
use crate::record_file::{FileError, entries, or_damage, read_json, short_hash, write_json};
use crate::window::failure::{FailureKind, RetryStep};
use crate::window::solve::WindowProblem;
use crate::window::versions::{RECIPE_VERSION, ToolVersions};
use hinge::HingeSample;
use mesher::{MeshRecipe, Tier};
use serde::{Deserialize, Serialize};
use std::fs::DirEntry;
use std::io;
use std::path::PathBuf;
use support::{regular_file, whole_file};

/// All inputs of the result of a job; its id is a hash of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JobSpec {
    /// The window solve.
    pub problem: WindowProblem,
    /// The mesh recipe of the tier.
    pub mesh: MeshRecipe,
    /// Versions of the external programs.
    pub tools: ToolVersions,
    /// Version of the geometry, the input deck and the evaluation.
    pub recipe_version: u32,
}

impl JobSpec {
    pub(crate) fn new(problem: WindowProblem, tools: &ToolVersions) -> Self {
        Self {
            mesh: problem.tier.recipe(),
            problem,
            tools: tools.clone(),
            recipe_version: RECIPE_VERSION,
        }
    }

    /// The id: 16 hexadecimal digits.
    pub fn id(&self) -> String {
        short_hash(self)
    }

    /// Names of the settings that differ from `other`; empty if only the ray differs.
    pub fn differences(&self, other: &Self) -> Vec<&'static str> {
        let (a, b) = (&self.problem, &other.problem);
        [
            (a.material != b.material, "material"),
            (a.tier != b.tier || self.mesh != other.mesh, "mesh tier"),
            (a.step != b.step, "step control"),
            (self.tools != other.tools, "tool versions"),
            (
                self.recipe_version != other.recipe_version,
                "recipe version",
            ),
        ]
        .into_iter()
        .filter_map(|(differs, what)| differs.then_some(what))
        .collect()
    }
}

/// The state of a job after its last attempt.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JobRecord {
    /// Why there are no samples, or only samples of a part of the ray; `None` for a complete ray.
    pub failure: Option<FailureKind>,
    /// The error message of the failure.
    pub message: Option<String>,
    /// The next retry; `None` closes the job.
    pub next: Option<RetryStep>,
    pub attempts: u32,
    /// Tier of the attempt that produced the rows.
    pub tier: Tier,
    /// Number of rows in `rows.csv`.
    pub rows: usize,
    /// Hash of `rows.csv`.
    pub rows_hash: String,
    /// Lambda of the last row; 1 for a complete ray.
    pub lambda: f64,
    /// Solver CPU time over all attempts (s).
    pub cpu_seconds: f64,
    /// Wall time over all attempts (s).
    pub wall_seconds: f64,
    /// Time at which the last attempt ended, in seconds since 1970.
    pub ended: u64,
}

impl JobRecord {
    /// Whether no retry is left.
    pub fn is_closed(&self) -> bool {
        self.next.is_none()
    }

    /// Whether the job was solved in this folder, not restored from a database, which has no wall times.
    pub(crate) fn is_solved_here(&self) -> bool {
        self.wall_seconds > 0.0
    }
}

/// The state of a job in its folder.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum JobState {
    /// No attempt has ended; `started` if an attempt was started.
    Open { started: bool },
    /// An attempt has ended.
    Ended(Box<(JobSpec, JobRecord)>),
    /// The files of the folder are damaged or inconsistent, with the reason. The job counts as open: the next run
    /// solves it again.
    Damaged(String),
}

/// File name prefix of the work folders.
const WORK: &str = "work-";

/// The folder of one job.
#[derive(Clone, Debug)]
pub struct JobFolder(pub PathBuf);

impl JobFolder {
    /// The state of the job. The consistency of its files is checked: the name of the folder must be the hash of
    /// `job.json`, and `result.json` contains the hash of `rows.csv`.
    pub(crate) fn state(&self) -> Result<JobState, FileError> {
        let damaged = |reason: &str| Ok(JobState::Damaged(reason.to_owned()));
        let spec = match or_damage(self.spec())? {
            Ok(spec) => spec,
            Err(_) => return damaged("job.json cannot be read"),
        };
        let record = match or_damage(self.record())? {
            Ok(record) => record,
            Err(_) => return damaged("result.json cannot be read"),
        };
        let id = self.0.file_name().unwrap_or_default();
        if spec.as_ref().is_some_and(|spec| *spec.id() != *id) {
            return damaged("job.json has changed: its hash is not the name of its folder");
        }
        match (spec, record) {
            (spec, None) => Ok(JobState::Open {
                started: spec.is_some(),
            }),
            (None, Some(_)) => damaged("job.json is missing"),
            (Some(spec), Some(record)) => {
                let rows = self.0.join("rows.csv");
                if record.rows > 0 && !rows.exists() {
                    return damaged("rows.csv is missing");
                }
                if record.rows > 0 && or_damage(self.rows(&record))?.is_err() {
                    return damaged("rows.csv does not match result.json");
                }
                Ok(JobState::Ended(Box::new((spec, record))))
            }
        }
    }

    /// Reads the inputs of the job; `None` if the job was never started.
    pub fn spec(&self) -> Result<Option<JobSpec>, FileError> {
        read_json(&self.0.join("job.json"))
    }

    /// Reads the state of the job; `None` before the first attempt has ended.
    pub fn record(&self) -> Result<Option<JobRecord>, FileError> {
        read_json(&self.0.join("result.json"))
    }

    /// Reads the samples; an error if their hash is not the one in `record`.
    pub fn samples(&self, record: &JobRecord) -> Result<Vec<HingeSample>, FileError> {
        let bytes = self.rows(record)?;
        let rows = csv::Reader::from_reader(&bytes[..]).into_deserialize();
        rows.collect::<Result<_, csv::Error>>().map_err(|error| {
            let damage = io::Error::new(io::ErrorKind::InvalidData, error);
            FileError::at(&self.0.join("rows.csv"))(damage)
        })
    }

    /// The bytes of `rows.csv`, which must have the hash in `record`.
    fn rows(&self, record: &JobRecord) -> Result<Vec<u8>, FileError> {
        let path = self.0.join("rows.csv");
        let bytes = regular_file::read(&path).map_err(FileError::at(&path))?;
        if blake3::hash(&bytes).to_hex().as_str() != record.rows_hash {
            let changed = "the rows do not match the hash in result.json: run the campaign again";
            let damage = io::Error::new(io::ErrorKind::InvalidData, changed);
            return Err(FileError::at(&path)(damage));
        }
        Ok(bytes)
    }

    pub(crate) fn write_spec(&self, spec: &JobSpec) -> Result<(), FileError> {
        whole_file::create_folder(&self.0).map_err(FileError::at(&self.0))?;
        write_json(&self.0.join("job.json"), spec)
    }

    /// Writes the samples so that every number is read back exactly; returns the hash of the file.
    pub(crate) fn write_samples(&self, samples: &[HingeSample]) -> Result<String, FileError> {
        let path = self.0.join("rows.csv");
        let mut writer = csv::Writer::from_writer(Vec::new());
        samples
            .iter()
            .try_for_each(|sample| writer.serialize(sample))
            .map_err(FileError::at(&path))?;
        let bytes = writer.into_inner().expect("a vector takes every byte");
        whole_file::write(&path, &bytes).map_err(FileError::at(&path))?;
        Ok(blake3::hash(&bytes).to_hex().to_string())
    }

    pub(crate) fn write_record(&self, record: &JobRecord) -> Result<(), FileError> {
        write_json(&self.0.join("result.json"), record)
    }

    /// The record of the job if its files are consistent; `None` if no attempt has ended, or if the files are damaged.
    pub(crate) fn ended(&self) -> Result<Option<JobRecord>, FileError> {
        Ok(match self.state()? {
            JobState::Ended(ended) => Some(ended.1),
            JobState::Open { .. } | JobState::Damaged(_) => None,
        })
    }

    /// The work folder of attempts on this host; another host may try the same job at the same time.
    fn work(&self) -> PathBuf {
        self.0.join(format!("{WORK}{}", host()))
    }

    /// Whether the folder has a work folder of any host: an attempt may be running, or was the last to fail.
    pub(crate) fn has_work(&self) -> Result<bool, FileError> {
        let is_work = |entry: &DirEntry| entry.file_name().to_string_lossy().starts_with(WORK);
        Ok(entries(&self.0)?.iter().any(is_work))
    }

    /// Creates an empty work folder for an attempt.
    pub(crate) fn fresh_work(&self) -> Result<PathBuf, FileError> {
        self.remove_work()?;
        let work = self.work();
        std::fs::create_dir_all(&work).map_err(FileError::at(&work))?;
        Ok(work)
    }

    /// Removes the work folder, if there is one.
    pub(crate) fn remove_work(&self) -> Result<(), FileError> {
        let work = self.work();
        match std::fs::remove_dir_all(&work) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                Err(FileError::at(&work)(error))
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn folder() -> (tempfile::TempDir, JobFolder) {
        let root = tempfile::tempdir().unwrap();
        let folder = JobFolder(root.path().to_owned());
        (root, folder)
    }

    proptest! {
        #[test]
        fn rows_are_read_back_bit_exactly(
            numbers in proptest::array::uniform4(proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL)
        ) {
            let [w, f_a, f_s, m_theta] = numbers;
            let rows = [HingeSample { w, f_a, f_s, m_theta, ..HingeSample::default() }; 2];
            let (_root, folder) = folder();
            let rows_hash = folder.write_samples(&rows).unwrap();
            let record = JobRecord { rows_hash, ..JobRecord::default() };
            prop_assert_eq!(&folder.samples(&record).unwrap()[..], &rows[..]);
        }
    }

    #[test]
    fn the_error_for_a_damaged_record_says_what_to_do() {
        let (_root, folder) = folder();
        assert!(folder.record().unwrap().is_none());
        folder.write_record(&JobRecord::default()).unwrap();
        assert_eq!(folder.record().unwrap(), Some(JobRecord::default()));
        let path = folder.0.join("result.json");
        std::fs::write(&path, "{\"failure\": nu").unwrap();
        let message = folder.record().unwrap_err().to_string();
        assert!(
            message.contains("result.json") && message.contains("delete it"),
            "{message}"
        );
    }
}
