//! A database: rows that belong together, their Parquet file and its manifest.

use crate::gates::{Gates, Rejection};
use crate::manifest::{FORMAT_VERSION, Manifest};
use crate::rows::Row;
use crate::split::{Part, SplitPlan};
use crate::{parquet, schema};
use hinge::TrainingDomain;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Why rows do not make a database, or a database could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum DatasetError {
    #[error("no rows ({rejected} were rejected); run the campaign before collecting it")]
    NoRows { rejected: usize },
    #[error(
        "job {job}: {column} = {found}, but other rows have {expected}; \
         keep each in a database of its own, or say that materials and tiers may be mixed"
    )]
    Mixed {
        job: String,
        column: &'static str,
        expected: String,
        found: String,
    },
    #[error("job {job}: lambda = {lambda} occurs twice; was the job collected twice?")]
    Duplicate { job: String, lambda: f64 },
    #[error(
        "{found} geometries cannot be split into training, validation and test: \
         at least 3 are needed"
    )]
    TooFewGeometries { found: usize },
    #[error("the databases are of different materials, {expected} and {found}")]
    OtherMaterial { expected: String, found: String },
    #[error(
        "{found} rays stand in both databases, the correction needs at least {needed}: solve more \
         rays of the one on the mesh of the other"
    )]
    TooFewRays { found: usize, needed: usize },
    #[error(
        "the shares validation = {validation} and test = {test} must each be above 0 and below 0.5"
    )]
    Shares { validation: f64, test: f64 },
    #[error("column `{column}` has no value in row {index}")]
    Gap { column: &'static str, index: usize },
    #[error(
        "there is no column `{column}`: name the one that holds it under [columns], or its value \
         under [constants]"
    )]
    NoColumn { column: String },
    #[error("column `{column}`, row {index}: `{text}` is not a number")]
    NotANumber {
        column: &'static str,
        index: usize,
        text: String,
    },
    #[error("the column map names `{key}`, which is no column of a database, or of another kind")]
    ColumnMap { key: String },
    #[error("job {job}, lambda = {lambda}: a number of the row is not finite")]
    NotFinite { job: String, lambda: f64 },
    #[error("cannot read {path}: {source}", path = .path.display())]
    Read {
        path: PathBuf,
        source: std::io::Error,
    },
    #[error("cannot write {path}: {source}", path = .path.display())]
    Write {
        path: PathBuf,
        source: std::io::Error,
    },
    #[error(
        "{path} exists; choose another name, or say that it shall be replaced",
        path = .path.display()
    )]
    Exists { path: PathBuf },
    #[error("{path} is no manifest of a database: {source}", path = .path.display())]
    Manifest {
        path: PathBuf,
        source: serde_json::Error,
    },
    #[error(
        "{path} has the format version {found}, this program reads 2 to {FORMAT_VERSION}; \
         collect the campaign again",
        path = .path.display()
    )]
    UnknownVersion { path: PathBuf, found: u64 },
    #[error(
        "{path} is not the file its manifest describes (BLAKE3 {found}, not {expected}); \
         copy the two files together, or collect the campaign again",
        path = .path.display()
    )]
    Hash {
        path: PathBuf,
        expected: String,
        found: String,
    },
    #[error("{path}: {source}", path = .path.display())]
    In {
        path: PathBuf,
        source: Box<DatasetError>,
    },
    #[error("the column `strain_volumes`: {0}")]
    StrainVolumes(#[from] hinge::NoHistogram),
    #[error("the table is not that of a database: {0}")]
    Table(#[from] polars::error::PolarsError),
}

/// Rows in the order of job and lambda, with the Parquet file that holds them and its manifest.
#[derive(Clone, Debug)]
pub struct Database {
    pub(crate) rows: Vec<Row>,
    pub(crate) parquet: Vec<u8>,
    pub(crate) manifest: Manifest,
}

impl Database {
    /// Drops what the gates reject, counting it, and splits the rest by geometry.
    ///
    /// Refuses rows of different materials, tiers or hinge constants.
    pub fn collect(rows: Vec<Row>, gates: &Gates, plan: &SplitPlan) -> Result<Self, DatasetError> {
        Self::assemble(rows, gates, plan, Mixing::Refused)
    }

    /// Several databases as one, split anew.
    ///
    /// A job that stands in more than one is taken once. Materials and tiers may be mixed if told
    /// so, hinge constants never: no feature of the surrogate tells them apart.
    pub fn merge(
        databases: &[Self],
        plan: &SplitPlan,
        mixing: Mixing,
    ) -> Result<Self, DatasetError> {
        let mut rows: Vec<Row> = Vec::new();
        let mut jobs: BTreeSet<&str> = BTreeSet::new();
        let mut rejected: BTreeMap<Rejection, usize> = BTreeMap::new();
        let mut gates = Gates {
            energy_residual_max: 0.0,
        };
        for database in databases {
            let new = |row: &&Row| !jobs.contains(row.job.as_str());
            let before = rows.len();
            rows.extend(database.rows.iter().filter(new).cloned());
            if rows.len() == before {
                continue;
            }
            jobs.extend(database.rows.iter().map(|row| row.job.as_str()));
            for (reason, count) in &database.manifest.rejected {
                *rejected.entry(*reason).or_default() += count;
            }
            let limit = database.manifest.gates.energy_residual_max;
            gates.energy_residual_max = gates.energy_residual_max.max(limit);
        }
        let mut merged = Self::assemble(rows, &gates, plan, mixing)?;
        merged.manifest.rejected = rejected;
        Ok(merged)
    }

    /// The same rows split by another plan.
    pub fn split(&self, plan: &SplitPlan) -> Result<Self, DatasetError> {
        Self::merge(std::slice::from_ref(self), plan, Mixing::Allowed)
    }

    /// The same parts for validation and test, and no more than the first `training` of the
    /// training rays. Ids are hashes, so that their order means nothing.
    pub fn thinned(&self, training: usize) -> Self {
        let mut thinned = self.clone();
        let split = &mut thinned.manifest.split;
        split.training = split.training.iter().take(training).cloned().collect();
        thinned.manifest.split_hash = split.hash();
        thinned
    }

    /// The same split, but for training and validation no state outside the domain.
    pub fn within(&self, domain: &TrainingDomain) -> Result<Self, DatasetError> {
        let split = &self.manifest.split;
        let test = split.jobs(Part::Test);
        let inside = |row: &&Row| {
            test.contains(&row.job) || domain.contains(&row.design, &row.sample.deformation())
        };
        let rows: Vec<Row> = self.rows.iter().filter(inside).cloned().collect();
        let jobs: BTreeSet<&str> = rows.iter().map(|row| row.job.as_str()).collect();
        let mut split = split.clone();
        for part in [&mut split.training, &mut split.validation] {
            part.retain(|job| jobs.contains(job.as_str()));
        }
        let mut within = self.with_rows(rows)?;
        within.manifest.split_hash = split.hash();
        within.manifest.split = split;
        Ok(within)
    }

    /// Other rows of the same jobs, through the same gates and split by the same plan.
    pub(crate) fn with_rows(&self, rows: Vec<Row>) -> Result<Self, DatasetError> {
        let Manifest {
            gates, split_plan, ..
        } = &self.manifest;
        let mut other = Self::assemble(rows, gates, split_plan, Mixing::Allowed)?;
        for (reason, count) in &self.manifest.rejected {
            *other.manifest.rejected.entry(*reason).or_default() += count;
        }
        Ok(other)
    }

    fn assemble(
        rows: Vec<Row>,
        gates: &Gates,
        plan: &SplitPlan,
        mixing: Mixing,
    ) -> Result<Self, DatasetError> {
        let mut rejected: BTreeMap<Rejection, usize> = BTreeMap::new();
        let mut rows: Vec<Row> = rows
            .into_iter()
            .filter(|row| match gates.rejection(row) {
                Some(reason) => {
                    *rejected.entry(reason).or_default() += 1;
                    false
                }
                None => true,
            })
            .collect();
        rows.sort_by(|left, right| {
            let by_lambda = || left.sample.lambda.total_cmp(&right.sample.lambda);
            left.job.cmp(&right.job).then_with(by_lambda)
        });
        refuse_mixed(&rows, mixing)?;
        refuse_duplicates(&rows)?;
        let parquet = parquet::encode(schema::to_frame(&rows)?)?;
        let hash = parquet::hash(&parquet);
        let manifest = Manifest::new(&rows, hash, gates, rejected, plan)?;
        Ok(Self {
            rows,
            parquet,
            manifest,
        })
    }

    /// Reads `X.parquet` and the manifest `X.json` beside it, which must describe it.
    pub fn read(path: &Path) -> Result<Self, DatasetError> {
        parquet::read(path)
    }

    /// Writes `X.parquet` and the manifest `X.json` beside it, each beside its place and renamed.
    ///
    /// An existing file is an error unless it is to be replaced.
    pub fn write(&self, path: &Path, replace: bool) -> Result<(), DatasetError> {
        parquet::write(self, path, replace)
    }

    /// All accepted rows.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// What the database says about itself.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// The rows of one part of the split.
    pub fn part(&self, part: Part) -> Vec<Row> {
        let jobs = self.manifest.split.jobs(part);
        let rows = self.rows.iter().filter(|row| jobs.contains(&row.job));
        rows.cloned().collect()
    }
}

/// Whether the rows of a database may be of different materials or mesh tiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mixing {
    Refused,
    Allowed,
}

/// What all rows must share: a surrogate knows none of it.
fn refuse_mixed(rows: &[Row], mixing: Mixing) -> Result<(), DatasetError> {
    let shared = |row: &Row| {
        let constants = [
            ("fillet_ratio", row.design.fillet_ratio.to_string()),
            ("kerf", format!("{} mm", row.design.kerf)),
            ("r_win", format!("{} mm", row.design.r_win)),
        ];
        let mixable = [
            ("material", row.material.clone()),
            ("material_hash", row.material_hash.clone()),
            ("settings_hash", row.settings_hash.clone()),
            ("tier", row.tier.clone()),
        ];
        let mixable = mixable.into_iter().filter(|_| mixing == Mixing::Refused);
        mixable.chain(constants).collect::<Vec<_>>()
    };
    let Some(first) = rows.first().map(shared) else {
        return Ok(());
    };
    for row in rows {
        for ((column, expected), (_, found)) in first.iter().zip(shared(row)) {
            if *expected != found {
                return Err(DatasetError::Mixed {
                    job: row.job.clone(),
                    column,
                    expected: expected.clone(),
                    found,
                });
            }
        }
    }
    Ok(())
}

/// `rows` are in the order of job and lambda.
fn refuse_duplicates(rows: &[Row]) -> Result<(), DatasetError> {
    let key = |row: &Row| (row.job.clone(), row.sample.lambda);
    match rows.windows(2).find(|pair| key(&pair[0]) == key(&pair[1])) {
        Some(pair) => Err(DatasetError::Duplicate {
            job: pair[0].job.clone(),
            lambda: pair[0].sample.lambda,
        }),
        None => Ok(()),
    }
}
