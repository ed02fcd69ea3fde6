//! One job of a campaign: its identity and its folder.
//!
//! The id is a hash of everything that decides the result. The folder holds `job.json` (what was
//! asked), `rows.csv` (the samples), the deck and log of the last attempt, and `result.json`,
//! written last: a job without it is not done. Every file is written beside and renamed.

use crate::failure::{FailureKind, Rung};
use crate::window_solve::{Tools, WindowProblem};
use hinge::{HingeSample, files};
use mesher::{MeshRecipe, Tier};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::io;
use std::path::{Path, PathBuf};

/// Version of the geometry, the deck and the evaluation: raised when a change of the code changes
/// results, so that jobs solved before are stale.
///
/// 2: D_peak is the mean over the most strained 1 % of the ligament.
const RECIPE_VERSION: u32 = 2;

/// Versions of the programs that decide a result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ToolVersions {
    pub gmsh: String,
    pub ccx: String,
}

impl ToolVersions {
    pub fn of(tools: &Tools) -> Self {
        Self {
            gmsh: tools.gmsh.0.version.clone(),
            ccx: tools.ccx.0.version.clone(),
        }
    }
}

/// What tells things apart that decide a result: 16 hexadecimal digits of the hash of their JSON.
pub(crate) fn short_hash(decisive: &impl Serialize) -> String {
    let text = serde_json::to_vec(decisive).expect("what decides a result is numbers and text");
    blake3::hash(&text).to_hex()[..16].to_owned()
}

/// Everything that decides the result of a job; what its id is a hash of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JobSpec {
    pub problem: WindowProblem,
    /// The mesh that the tier stands for.
    pub mesh: MeshRecipe,
    pub tools: ToolVersions,
    pub recipe_version: u32,
}

impl JobSpec {
    pub fn new(problem: WindowProblem, tools: &ToolVersions) -> Self {
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

    /// What differs from `other`, in words; empty if only the ray does.
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

/// How a job stands after its last attempt.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JobRecord {
    /// Why there are no samples, or not all; `None` for a whole ray.
    pub failure: Option<FailureKind>,
    /// The failure in words.
    pub message: Option<String>,
    /// What is to be tried next; `None` closes the job.
    pub next: Option<Rung>,
    pub attempts: u32,
    /// Tier of the attempt that the rows are from.
    pub tier: Tier,
    /// Rows in `rows.csv`.
    pub rows: usize,
    /// Hash of `rows.csv`.
    pub rows_hash: String,
    /// Where the rows end; 1 for a whole ray.
    pub lambda: f64,
    /// Of the solver, over all attempts (s).
    pub cpu_seconds: f64,
    /// Of all attempts (s).
    pub wall_seconds: f64,
    /// Seconds since 1970.
    pub ended: u64,
}

impl JobRecord {
    /// Whether nothing is left to try.
    pub fn is_closed(&self) -> bool {
        self.next.is_none()
    }
}

/// A file of a campaign that cannot be read, written or understood.
#[derive(Debug, thiserror::Error)]
#[error("{path}: {source}", path = .path.display())]
pub struct FileError {
    pub path: PathBuf,
    pub source: io::Error,
}

impl FileError {
    /// For `map_err` on what was done to `path`.
    pub(crate) fn at<E: Into<io::Error>>(path: &Path) -> impl FnOnce(E) -> Self {
        let path = path.to_owned();
        move |source| Self {
            path,
            source: source.into(),
        }
    }
}

/// The folder of one job.
#[derive(Clone, Debug)]
pub struct JobFolder(pub PathBuf);

impl JobFolder {
    /// Reads what was asked; `None` if the folder has none.
    pub fn spec(&self) -> Result<Option<JobSpec>, FileError> {
        read_json(&self.0.join("job.json"))
    }

    /// Reads how the job stands; `None` before the first attempt has ended.
    pub fn record(&self) -> Result<Option<JobRecord>, FileError> {
        read_json(&self.0.join("result.json"))
    }

    /// Reads the samples, which must be those that `record` was written for.
    pub fn samples(&self, record: &JobRecord) -> Result<Vec<HingeSample>, FileError> {
        let path = self.0.join("rows.csv");
        let bytes = std::fs::read(&path).map_err(FileError::at(&path))?;
        if blake3::hash(&bytes).to_hex().as_str() != record.rows_hash {
            let changed = "not the rows that result.json was written for: run the campaign again";
            return Err(FileError::at(&path)(io::Error::other(changed)));
        }
        let rows = csv::Reader::from_reader(&bytes[..]).into_deserialize();
        rows.collect::<Result<_, csv::Error>>()
            .map_err(FileError::at(&path))
    }

    pub(crate) fn write_spec(&self, spec: &JobSpec) -> Result<(), FileError> {
        std::fs::create_dir_all(&self.0).map_err(FileError::at(&self.0))?;
        write_json(&self.0.join("job.json"), spec)
    }

    /// Writes the samples, every number so that it reads back exactly; returns their hash.
    pub(crate) fn write_samples(&self, samples: &[HingeSample]) -> Result<String, FileError> {
        let path = self.0.join("rows.csv");
        let mut writer = csv::Writer::from_writer(Vec::new());
        samples
            .iter()
            .try_for_each(|sample| writer.serialize(sample))
            .map_err(FileError::at(&path))?;
        let bytes = writer.into_inner().expect("a vector takes every byte");
        files::write(&path, &bytes).map_err(FileError::at(&path))?;
        Ok(blake3::hash(&bytes).to_hex().to_string())
    }

    pub(crate) fn write_record(&self, record: &JobRecord) -> Result<(), FileError> {
        write_json(&self.0.join("result.json"), record)
    }

    /// The empty folder of an attempt.
    pub(crate) fn fresh_work(&self) -> Result<PathBuf, FileError> {
        let work = self.0.join("work");
        match std::fs::remove_dir_all(&work) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                return Err(FileError::at(&work)(error));
            }
            _ => {}
        }
        std::fs::create_dir_all(&work).map_err(FileError::at(&work))?;
        Ok(work)
    }

    /// Keeps the deck and the log of a success, and drops the rest of the attempt.
    pub(crate) fn tidy(&self) -> Result<(), FileError> {
        let work = self.0.join("work");
        for name in ["window.inp", "window.log"] {
            std::fs::rename(work.join(name), self.0.join(name)).map_err(FileError::at(&work))?;
        }
        std::fs::remove_dir_all(&work).map_err(FileError::at(&work))
    }
}

/// Reads a JSON file; `None` if there is none.
pub(crate) fn read_json<T: DeserializeOwned>(path: &Path) -> Result<Option<T>, FileError> {
    match std::fs::read(path) {
        Ok(bytes) => serde_json::from_slice(&bytes).map(Some).map_err(|error| {
            let hint = "damaged; delete it, and the next run writes it anew";
            FileError::at(path)(io::Error::other(format!("{error}: {hint}")))
        }),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(FileError::at(path)(error)),
    }
}

pub(crate) fn write_json<T: Serialize>(path: &Path, value: &T) -> Result<(), FileError> {
    let bytes = serde_json::to_vec_pretty(value).map_err(FileError::at(path))?;
    files::write(path, &bytes).map_err(FileError::at(path))
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
        fn rows_read_back_to_the_last_bit(
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
    fn a_damaged_record_says_what_to_do() {
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
