//! The manifest `X.json` of a database `X.parquet`.

use crate::gates::{Gates, Rejection};
use crate::rows::Row;
use crate::split::{Split, SplitPlan};
use hinge::{HingeConstants, TrainingDomain};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Format version of the Parquet file and its manifest; no other version is read.
pub const FORMAT_VERSION: u32 = 4;

/// The metadata of a database.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// [`FORMAT_VERSION`] of the writer.
    pub format_version: u32,
    /// BLAKE3 of the Parquet file.
    pub hash: String,
    /// Unit of each column that has a unit.
    pub units: BTreeMap<String, String>,
    /// Number of rows.
    pub rows: usize,
    /// Jobs with at least one row.
    pub rays: usize,
    /// Rays that stopped before their end.
    pub partial_rays: usize,
    /// Number of distinct (w_lig, alpha), up to mirroring.
    pub geometries: usize,
    /// CPU time of all rays (s).
    pub cpu_s: f64,
    /// The gates that all rows have passed.
    pub gates: Gates,
    /// Number of rejected rows by reason.
    pub rejected: BTreeMap<Rejection, usize>,
    /// Name of the material; mixed materials are written "a + b".
    pub material: String,
    /// Hashes of the material laws; the set is empty, or contains an empty hash, if they are unknown.
    pub material_hashes: BTreeSet<String>,
    /// Hashes of the campaigns' settings; the set is empty, or contains an empty hash, if they are unknown.
    pub settings_hashes: BTreeSet<String>,
    /// Tier of the window mesh, as parsed by [`Fidelity::from_tier`](crate::Fidelity::from_tier); mixed tiers are written "a + b".
    pub tier: String,
    /// The constants of all hinges; if they have holes of several radii (`domain.holes`), `fillet_ratio` is the paper's.
    pub hinge: HingeConstants,
    /// Versions of gmsh that meshed the rows.
    pub gmsh: BTreeSet<String>,
    /// Versions of ccx that solved the rows.
    pub ccx: BTreeSet<String>,
    /// The set of states that the rows cover.
    pub domain: TrainingDomain,
    /// How the geometries were assigned to the parts.
    pub split_plan: SplitPlan,
    /// BLAKE3 of the split.
    pub split_hash: String,
    /// The jobs of each part.
    pub split: Split,
}

impl Manifest {
    /// What of the manifest is not true of the rows; `None` if all that is checked holds.
    pub(crate) fn disagrees(&self, rows: &[Row]) -> Option<&'static str> {
        let jobs: BTreeSet<&str> = rows.iter().map(|row| row.job.as_str()).collect();
        let Split {
            training,
            validation,
            test,
        } = &self.split;
        let parts = [training, validation, test];
        let mut dealt = parts.into_iter().flatten();
        if self.rows != rows.len() || self.rays != jobs.len() {
            Some("the numbers of rows or rays differ")
        } else if self.split_hash != self.split.hash() {
            Some("the split does not match its hash")
        } else if !dealt.all(|job| jobs.contains(job.as_str())) {
            Some("the split names a ray that has no rows")
        } else {
            None
        }
    }
}
