//! The manifest `X.json` of a database `X.parquet`.

use crate::schema::is_finite;
use crate::split::{Split, SplitPlan};
use fe_driver::{Fidelity, SolvedRay};
use hinge::{HingeConstants, HingeSample, TrainingDomain};
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
    /// What of the manifest is not true of the rays; `None` if all that is checked holds.
    pub(crate) fn disagrees(&self, rays: &[SolvedRay]) -> Option<&'static str> {
        let jobs: BTreeSet<&str> = rays.iter().map(|ray| ray.job.as_str()).collect();
        let rows: usize = rays.iter().map(|ray| ray.samples.len()).sum();
        let Split { training, validation, test } = &self.split;
        let parts = [training, validation, test];
        let mut dealt = parts.into_iter().flatten();
        let finer = self.finer.as_ref().map_or(0, |finer| finer.rays);
        if self.rows != rows || self.rays + finer != jobs.len() {
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

// Criteria by which rows are rejected from the database. Rows are never repaired.

/// Limits that an accepted row satisfies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AcceptanceLimits {
    /// Maximum accepted [`hinge::HingeSample::energy_residual`]: relative difference of the
    /// solver's energy and the work of its reaction forces.
    pub energy_residual_max: f64,
}

impl Default for AcceptanceLimits {
    /// Converged rays stay below 1e-3; ten times this value is not explained by the error of the
    /// quadrature.
    fn default() -> Self {
        Self { energy_residual_max: 0.01 }
    }
}

/// Why a row was rejected: the first reason that applies.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, thiserror::Error,
)]
#[serde(rename_all = "kebab-case")]
pub enum Rejection {
    /// A number is not finite.
    #[error("a number is not finite")]
    NotFinite,
    /// The design cannot be cut; see [`hinge::HingeDesign::validate`].
    #[error(
        "the hinge cannot be cut or is outside of the limits of its keys (lengths in mm, angles in rad?)"
    )]
    InvalidDesign,
    /// W < 0 or D < 0.
    #[error("W or D is negative")]
    Negative,
    /// The energy and the work of the reaction forces differ by more than the limit.
    #[error("the energy is not the work of the forces (units of W, forces and lengths?)")]
    EnergyResidual,
}

impl AcceptanceLimits {
    /// Why a sample of a ray is rejected; `None` if it is accepted.
    pub fn rejection(&self, ray: &SolvedRay, sample: &HingeSample) -> Option<Rejection> {
        if !is_finite(ray, sample) {
            Some(Rejection::NotFinite)
        } else if ray.design.validate().is_err() {
            Some(Rejection::InvalidDesign)
        } else if sample.w < 0.0 || sample.d < 0.0 {
            Some(Rejection::Negative)
        } else if sample.energy_residual > self.energy_residual_max {
            Some(Rejection::EnergyResidual)
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rays::tests::ray;

    #[test]
    fn each_limit_rejects_its_own_defect() {
        let limits = AcceptanceLimits::default();
        type Change = fn(&mut SolvedRay);
        let with = |change: Change| {
            let mut ray = ray(0);
            change(&mut ray);
            limits.rejection(&ray, &ray.samples[4])
        };
        assert_eq!(with(|_| ()), None);
        let cases: [(Change, Rejection); 5] = [
            (|ray| ray.samples[4].f_s = f64::NAN, Rejection::NotFinite),
            (|ray| ray.design.alpha = 4.0, Rejection::InvalidDesign),
            (|ray| ray.samples[4].w = -1e-9, Rejection::Negative),
            (|ray| ray.samples[4].d = -1e-9, Rejection::Negative),
            (|ray| ray.samples[4].energy_residual = 0.021, Rejection::EnergyResidual),
        ];
        for (change, expected) in cases {
            assert_eq!(with(change), Some(expected));
        }
    }
}
