//! The manifest `X.json` of a database `X.parquet`.

use crate::acceptance::{AcceptanceLimits, Rejection};
use crate::rows::{Fidelity, Row};
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
    /// Number of rows, of both meshes.
    pub rows: usize,
    /// Jobs of the mesh `tier` with at least one row.
    pub rays: usize,
    /// Rays that stopped before their end.
    pub partial_rays: usize,
    /// Number of distinct (w_lig, alpha), up to mirroring.
    pub geometries: usize,
    /// CPU time of these rays (s).
    pub cpu_s: f64,
    /// Whether the rays bend like the free turn of a ligament, as [`hinge::Regime::free_opening`]
    /// has it for plates, and are not straight.
    #[serde(default)]
    pub bent_rays: bool,
    /// The finer mesh on which some of the rays were solved too.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub finer: Option<FinerMesh>,
    /// The limits that all rows satisfy.
    pub gates: AcceptanceLimits,
    /// Number of rejected rows by reason.
    pub rejected: BTreeMap<Rejection, usize>,
    /// Name of the material.
    pub material: String,
    /// Hash of the material law; the set is empty, or contains an empty hash, if it is unknown.
    pub material_hashes: BTreeSet<String>,
    /// Hash of the campaign's settings; the set is empty, or contains an empty hash, if they are
    /// unknown.
    pub settings_hashes: BTreeSet<String>,
    /// The window mesh.
    pub tier: Fidelity,
    /// The constants of all hinges; if they have holes of several radii (`domain.holes`),
    /// `fillet_ratio` is the paper's.
    pub hinge: HingeConstants,
    /// Versions of gmsh that meshed the rows.
    pub gmsh: BTreeSet<String>,
    /// Versions of ccx that solved the rows.
    pub ccx: BTreeSet<String>,
    /// The set of states that the rows of the mesh `tier` cover.
    pub domain: TrainingDomain,
    /// How the geometries were assigned to the parts.
    pub split_plan: SplitPlan,
    /// BLAKE3 of the split.
    pub split_hash: String,
    /// The jobs of each part.
    pub split: Split,
}

/// The finer mesh of a database.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FinerMesh {
    /// Its tier.
    pub tier: Fidelity,
    /// Number of rays that were solved on it.
    pub rays: usize,
    /// Their CPU time (s).
    pub cpu_s: f64,
}

impl Manifest {
    /// What of the manifest is not true of the rows; `None` if all that is checked holds.
    pub(crate) fn disagrees(&self, rows: &[Row]) -> Option<&'static str> {
        let jobs: BTreeSet<&str> = rows.iter().map(|row| row.job.as_str()).collect();
        let Split { training, validation, test } = &self.split;
        let parts = [training, validation, test];
        let mut dealt = parts.into_iter().flatten();
        let finer = self.finer.as_ref().map_or(0, |finer| finer.rays);
        if self.rows != rows.len() || self.rays + finer != jobs.len() {
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
