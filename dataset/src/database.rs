//! A database: consistent rows, their Parquet file and its manifest.

use crate::digest::{Digest, by_job_and_lambda};
use crate::error::DatasetError;
use crate::gates::Rejection;
use crate::manifest::Manifest;
use crate::mixing::Mixing;
use crate::parquet;
use crate::rows::Row;
use crate::split::{Part, Split, SplitPlan, geometry};
use std::collections::{BTreeMap, BTreeSet};

/// Rows in the order of job and lambda, with the bytes of their Parquet file and its manifest.
#[derive(Clone, Debug)]
pub struct Database {
    pub(crate) rows: Vec<Row>,
    pub(crate) parquet: Vec<u8>,
    pub(crate) manifest: Manifest,
}

impl Database {
    /// Drops and counts the rows that the gates reject, and splits the others by geometry.
    ///
    /// Rows of different materials, tiers or hinge constants are an error.
    pub fn collect(rows: Vec<Row>, plan: &SplitPlan) -> Result<Self, DatasetError> {
        Self::assemble(rows, plan, Mixing::Refused)
    }

    /// Merges several databases into one and splits it again.
    ///
    /// A job that several databases contain is taken once. Materials and tiers may be mixed if `mixing` allows it.
    /// Hinge constants may not be mixed, because the surrogate has no feature for them.
    pub fn merge(
        databases: &[Self],
        plan: &SplitPlan,
        mixing: Mixing,
    ) -> Result<Self, DatasetError> {
        let mut rows: Vec<Row> = Vec::new();
        let mut jobs: BTreeSet<&str> = BTreeSet::new();
        let mut rejected: BTreeMap<Rejection, usize> = BTreeMap::new();
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
        }
        let mut merged = Self::assemble(rows, plan, mixing)?;
        merged.manifest.rejected = rejected;
        Ok(merged)
    }

    /// The same rows, split according to another plan.
    pub fn split(&self, plan: &SplitPlan) -> Result<Self, DatasetError> {
        Self::merge(std::slice::from_ref(self), plan, Mixing::Allowed)
    }

    /// The same rows, each geometry in the part that it has in `other`. A geometry that `other` lacks is for training.
    ///
    /// Weights that were trained on `other` can be fine-tuned on this database: its validation and test parts have no
    /// geometry that they were trained on. It is an error if one of these parts is empty.
    pub fn split_like(&self, other: &Self) -> Result<Self, DatasetError> {
        let parts = [Part::Validation, Part::Test].map(|part| (part, other.geometries(part)));
        let mut alike = self.clone().with_parts(|row| {
            let known = parts.iter().find(|(_, of)| of.contains(&geometry(row)));
            Some(known.map_or(Part::Training, |(part, _)| *part))
        });
        alike.manifest.split_plan = other.manifest.split_plan;
        let split = &alike.manifest.split;
        if split.validation.is_empty() || split.test.is_empty() {
            Err(DatasetError::NotAlike)
        } else {
            Ok(alike)
        }
    }

    /// A database of other rows of the same jobs, with the same split.
    pub(crate) fn with_rows(&self, rows: Vec<Row>) -> Result<Self, DatasetError> {
        let Manifest {
            split_plan, split, ..
        } = &self.manifest;
        let mut other = Self::assemble(rows, split_plan, Mixing::Allowed)?;
        for (reason, count) in &self.manifest.rejected {
            *other.manifest.rejected.entry(*reason).or_default() += count;
        }
        Ok(other.with_parts(|row| split.part(&row.job)))
    }

    /// The same rows, each job in the part of its first row; a job without a part is not used.
    fn with_parts(self, part: impl Fn(&Row) -> Option<Part>) -> Self {
        let mut split = Split::default();
        for ray in self.rays() {
            if let Some(part) = part(&ray[0]) {
                split.jobs_mut(part).insert(ray[0].job.clone());
            }
        }
        self.with_split(split)
    }

    fn with_split(mut self, split: Split) -> Self {
        self.manifest.split_hash = split.hash();
        self.manifest.split = split;
        self
    }

    fn assemble(rows: Vec<Row>, plan: &SplitPlan, mixing: Mixing) -> Result<Self, DatasetError> {
        let mut digest = Digest::new(mixing);
        let mut rows = digest.accepted(rows);
        rows.sort_by(by_job_and_lambda);
        for ray in rows.chunk_by(|left, right| left.job == right.job) {
            digest.add(ray)?;
        }
        let parquet = parquet::encode(&rows)?;
        let manifest = digest.manifest(parquet::hash(&parquet), plan)?;
        Ok(Self {
            rows,
            parquet,
            manifest,
        })
    }

    /// The geometries of one part of the split.
    pub(crate) fn geometries(&self, part: Part) -> BTreeSet<[i64; 2]> {
        let jobs = self.manifest.split.jobs(part);
        let rows = self.rows.iter().filter(|row| jobs.contains(&row.job));
        rows.map(geometry).collect()
    }

    /// The rows of each ray, in the order of lambda.
    pub(crate) fn rays(&self) -> Vec<&[Row]> {
        let same = |left: &Row, right: &Row| left.job == right.job;
        self.rows.chunk_by(same).collect()
    }

    /// The first row of every ray that was solved on another tier than that of its campaign, after a failure.
    pub fn rays_on_other_tiers(&self) -> Vec<&Row> {
        let first = self.rays().into_iter().filter_map(<[Row]>::first);
        first.filter(|row| !row.is_as_asked()).collect()
    }

    /// All accepted rows.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// The metadata of the database.
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
