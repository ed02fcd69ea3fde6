//! A database: consistent rays, their Parquet file and its manifest.

use crate::digest::Digest;
use crate::manifest::Manifest;
use crate::parquet;
use crate::rays::samples;
use crate::schema::{COLUMNS, no_table};
use crate::split::{SplitPlan, Subset, geometry};
use fe_driver::{Fidelity, SolvedRay};
use std::collections::BTreeSet;
use support::{Fault, fault};

/// Rays in the order of their jobs, with the bytes of their Parquet file and its manifest.
#[derive(Clone, Debug)]
pub struct Database {
    pub(crate) rays: Vec<SolvedRay>,
    pub(crate) parquet: Vec<u8>,
    pub(crate) manifest: Manifest,
}

impl Database {
    /// Drops and counts the samples outside the acceptance limits, and splits the rays by geometry.
    ///
    /// Rays of different materials or hinge constants are an error, and rays of two tiers without a
    /// common one.
    pub fn collect(rays: Vec<SolvedRay>, plan: &SplitPlan) -> Result<Self, Fault> {
        let mut digest = Digest::default();
        let mut rays: Vec<SolvedRay> = rays.into_iter().map(|ray| digest.accepted(ray)).collect();
        rays.retain(|ray| !ray.samples.is_empty());
        rays.sort_by(|left, right| left.job.cmp(&right.job));
        rays.iter().try_for_each(|ray| digest.add(ray))?;
        let parquet = parquet::encode(&rays).map_err(no_table)?;
        let manifest = digest.manifest(parquet::hash(&parquet), plan)?;
        Ok(Self { rays, parquet, manifest })
    }

    /// A database of other samples of the rays, with the same split. Its hash is the hash of this
    /// file, from which it follows.
    pub(crate) fn with_rays(&self, rays: Vec<SolvedRay>) -> Result<Self, Fault> {
        let ours = &self.manifest;
        let mut other = Self::collect(rays, &ours.split_plan)?;
        for (reason, count) in &ours.rejected {
            *other.manifest.rejected.entry(*reason).or_default() += count;
        }
        other.manifest.hash.clone_from(&ours.hash);
        let split = ours.split.of(other.rays.iter().map(|ray| &ray.job).collect());
        other.manifest.split_hash = split.hash();
        other.manifest.split = split;
        Ok(other)
    }

    /// The geometries of one part of the split.
    pub(crate) fn geometries(&self, part: Subset) -> BTreeSet<[i64; 2]> {
        self.in_part(part).map(|ray| geometry(&ray.design)).collect()
    }

    /// The rays that were solved on another tier than the tier of their campaign, after a failure.
    pub fn rays_on_other_tiers(&self) -> Vec<&SolvedRay> {
        self.rays.iter().filter(|ray| !ray.at_requested_tier()).collect()
    }

    /// The rays on a mesh.
    pub(crate) fn on_tier(&self, tier: Fidelity) -> impl Iterator<Item = &SolvedRay> {
        self.rays.iter().filter(move |ray| ray.tier == tier)
    }

    /// All rays with accepted samples, including those on the finer mesh.
    pub fn rays(&self) -> &[SolvedRay] {
        &self.rays
    }

    /// The metadata of the database.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// The rays of one part of the split.
    pub fn part(&self, part: Subset) -> Vec<SolvedRay> {
        self.in_part(part).cloned().collect()
    }

    fn in_part(&self, part: Subset) -> impl Iterator<Item = &SolvedRay> {
        let jobs = self.manifest.split.jobs(part);
        self.rays.iter().filter(|ray| jobs.contains(&ray.job))
    }

    /// The table as CSV, in full precision.
    pub fn to_csv(&self) -> Result<Vec<u8>, Fault> {
        self.csv().map_err(|error| fault!("the table cannot be written as CSV: {error}"))
    }

    fn csv(&self) -> csv::Result<Vec<u8>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(COLUMNS.iter().map(|column| column.name))?;
        for (ray, sample) in samples(&self.rays) {
            writer.write_record(COLUMNS.iter().map(|column| column.text(ray, sample)))?;
        }
        Ok(writer.into_inner().expect("a vector takes every byte"))
    }
}
