//! Errors of collecting, reading, writing and correcting a database.

use std::path::PathBuf;
use support::file_error::FileError;

/// Why a database cannot be collected, read, written or corrected.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum DatasetError {
    #[error("no rows: {why}")]
    NoRows { why: String },
    #[error(
        "job {job}: {column} = {found}, but other rows have {expected}; \
         collect them in separate databases"
    )]
    Mixed { job: String, column: &'static str, expected: String, found: String },
    #[error("job {job}: lambda = {lambda} occurs twice; was the job collected twice?")]
    Duplicate { job: String, lambda: f64 },
    #[error(
        "{found} geometries cannot be split into training, validation and test: \
         at least 3 are needed"
    )]
    TooFewGeometries { found: usize },
    #[error(
        "{found} rays are solved on the finer mesh too, but the correction needs at least {needed}: increase `finer` in the \
         campaign"
    )]
    TooFewRays { found: usize, needed: usize },
    #[error("the fractions validation = {validation} and test = {test} violate 0 < fraction < 0.5")]
    Shares { validation: f64, test: f64 },
    #[error("column `{column}` has no value in row {index}")]
    Gap { column: &'static str, index: usize },
    #[error("job {job}, lambda = {lambda}: the row contains a number that is not finite")]
    NotFinite { job: String, lambda: f64 },
    #[error(
        "the file claims {values} values in {bytes} bytes, which measured data never do: it is damaged, or made to fill \
         the memory"
    )]
    Expanding { values: usize, bytes: usize },
    #[error(
        "the texts of the table exceed {most} bytes at row {index} of the column `{column}`: the file is damaged, or made to fill \
         the memory"
    )]
    LongText { column: &'static str, index: usize, most: usize },
    #[error("the file is malformed: the Parquet reader fails with `{0}`")]
    Malformed(String),
    #[error("cannot read {0}")]
    Read(#[source] FileError),
    #[error("cannot write {0}")]
    Write(#[source] FileError),
    #[error(
        "{path} already exists; choose another name, or replace it with `--replace`",
        path = .path.display()
    )]
    Exists { path: PathBuf },
    #[error("{path} {what}: a database is a Parquet file (.parquet) with its manifest", path = .path.display())]
    NoDatabase { path: PathBuf, what: &'static str },
    #[error("{path} is not a manifest of a database: {source}", path = .path.display())]
    Manifest { path: PathBuf, source: support::sealed_json::SealError },
    #[error(
        "{path} has the format version {found}, but this program reads version {expected} alone: collect the campaign \
         again, or use the program that wrote it",
        path = .path.display()
    )]
    UnknownVersion { path: PathBuf, found: u64, expected: u32 },
    #[error(
        "{path} does not match its manifest (its BLAKE3 hash is {found}, not {expected}); \
         copy both files from the same place, or collect the campaign again",
        path = .path.display()
    )]
    Hash { path: PathBuf, expected: String, found: String },
    #[error(
        "{path} and its manifest do not belong together: {what}; copy the two files again, or collect the campaign again",
        path = .path.display()
    )]
    OtherRows { path: PathBuf, what: &'static str },
    #[error("{path}: {source}", path = .path.display())]
    In { path: PathBuf, source: Box<DatasetError> },
    #[error("the table is not a valid database: {0}")]
    Table(#[from] polars::error::PolarsError),
    #[error("the table cannot be written as CSV: {0}")]
    Csv(#[from] csv::Error),
}
