//! A database: consistent rows, their Parquet file and its manifest.

use crate::digest::{Digest, by_job_and_lambda};
use crate::manifest::Manifest;
use crate::parquet;
use crate::rows::{Fidelity, Row};
use crate::schema::{COLUMNS, DatasetError};
use crate::split::{SplitPlan, Subset, geometry};
use std::collections::BTreeSet;
use support::{Fault, fault};

/// Rows in the order of job and lambda, with the bytes of their Parquet file and its manifest.
#[derive(Clone, Debug)]
pub struct Database {
    pub(crate) rows: Vec<Row>,
    pub(crate) parquet: Vec<u8>,
    pub(crate) manifest: Manifest,
}

impl Database {
    /// Drops and counts the rows outside the acceptance limits, and splits the others by geometry.
    ///
    /// Rows of different materials or hinge constants are an error, and rows of two tiers without a
    /// common ray.
    pub fn collect(rows: Vec<Row>, plan: &SplitPlan) -> Result<Self, DatasetError> {
        let mut digest = Digest::default();
        let mut rows = digest.accepted(rows);
        rows.sort_by(by_job_and_lambda);
        for ray in rows.chunk_by(|left, right| left.job == right.job) {
            digest.add(ray)?;
        }
        let parquet = parquet::encode(&rows)?;
        let manifest = digest.manifest(parquet::hash(&parquet), plan)?;
        Ok(Self { rows, parquet, manifest })
    }

    /// A database of other rows of the rays, with the same split. Its hash is the hash of this
    /// file, from which it follows.
    pub(crate) fn with_rows(&self, rows: Vec<Row>) -> Result<Self, DatasetError> {
        let ours = &self.manifest;
        let mut other = Self::collect(rows, &ours.split_plan)?;
        for (reason, count) in &ours.rejected {
            *other.manifest.rejected.entry(*reason).or_default() += count;
        }
        other.manifest.hash.clone_from(&ours.hash);
        let split = ours.split.of(other.rows.iter().map(|row| &row.job).collect());
        other.manifest.split_hash = split.hash();
        other.manifest.split = split;
        Ok(other)
    }

    /// The geometries of one part of the split.
    pub(crate) fn geometries(&self, part: Subset) -> BTreeSet<[i64; 2]> {
        let jobs = self.manifest.split.jobs(part);
        let rows = self.rows.iter().filter(|row| jobs.contains(&row.job));
        rows.map(geometry).collect()
    }

    /// The rows of each ray, in the order of lambda.
    pub(crate) fn rays(&self) -> Vec<&[Row]> {
        let same = |left: &Row, right: &Row| left.job == right.job;
        self.rows.chunk_by(same).collect()
    }

    /// The first row of every ray that was solved on another tier than the tier of its campaign,
    /// after a failure.
    pub fn rays_on_other_tiers(&self) -> Vec<&Row> {
        let first = self.rays().into_iter().filter_map(<[Row]>::first);
        first.filter(|row| !row.at_requested_tier()).collect()
    }

    /// The rows on a mesh.
    pub(crate) fn on_tier(&self, tier: Fidelity) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(move |row| row.tier == tier)
    }

    /// All accepted rows, including the rows of the finer mesh.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// The metadata of the database.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// The rows of one part of the split.
    pub fn part(&self, part: Subset) -> Vec<Row> {
        let jobs = self.manifest.split.jobs(part);
        let rows = self.rows.iter().filter(|row| jobs.contains(&row.job));
        rows.cloned().collect()
    }

    /// The table as CSV, in full precision.
    pub fn to_csv(&self) -> Result<Vec<u8>, Fault> {
        self.csv().map_err(|error| fault!("the table cannot be written as CSV: {error}"))
    }

    fn csv(&self) -> csv::Result<Vec<u8>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(COLUMNS.iter().map(|column| column.name))?;
        for row in &self.rows {
            writer.write_record(COLUMNS.iter().map(|column| column.text(row)))?;
        }
        Ok(writer.into_inner().expect("a vector takes every byte"))
    }
}
