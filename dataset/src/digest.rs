//! What the manifest and the summary need of the rows of a database, gathered ray by ray: the rows
//! themselves need not be in memory at the same time.

use crate::acceptance::{AcceptanceLimits, Rejection};
use crate::error::DatasetError;
use crate::manifest::{FORMAT_VERSION, FinerMesh, Manifest};
use crate::meshes::Meshes;
use crate::rows::Row;
use crate::schema::COLUMNS;
use crate::split::{Split, SplitPlan};
use hinge::{HingeConstants, TrainingDomain};
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use support::{fault, refuse};

/// The order of the rows of a database.
pub(crate) fn by_job_and_lambda(left: &Row, right: &Row) -> Ordering {
    let by_lambda = || left.sample.lambda.total_cmp(&right.sample.lambda);
    left.job.cmp(&right.job).then_with(by_lambda)
}

/// What is known of the rows so far.
#[derive(Default)]
pub(crate) struct Digest {
    rejected: BTreeMap<Rejection, usize>,
    /// Job and lambda of the last accepted row.
    last: Option<(String, f64)>,
    rows: usize,
    meshes: Meshes,
    /// The different values of every column of text, in the order of [`TEXTS`].
    texts: [BTreeSet<String>; TEXTS.len()],
}

/// The columns of text whose values the manifest lists.
const TEXTS: [fn(&Row) -> &String; 4] =
    [|row| &row.material, |row| &row.material_hash, |row| &row.tools.gmsh, |row| &row.tools.ccx];

impl Digest {
    /// The rows within the acceptance limits; the others are counted.
    pub(crate) fn accepted(&mut self, mut rows: Vec<Row>) -> Vec<Row> {
        rows.retain(|row| match AcceptanceLimits::default().rejection(row) {
            Some(reason) => {
                *self.rejected.entry(reason).or_default() += 1;
                false
            }
            None => true,
        });
        rows
    }

    /// Adds accepted rows of one job, in the order of lambda. The jobs must come in the order of
    /// their ids.
    pub(crate) fn add(&mut self, ray: &[Row]) -> Result<(), DatasetError> {
        for row in ray {
            self.refuse_duplicate(row)?;
            for (values, text) in self.texts.iter_mut().zip(TEXTS) {
                if !values.contains(text(row)) {
                    values.insert(text(row).clone());
                }
            }
        }
        self.rows += ray.len();
        self.meshes.add(ray)
    }

    /// Rejects a row that does not come after the last one: one with the same job and lambda.
    fn refuse_duplicate(&mut self, row: &Row) -> Result<(), DatasetError> {
        let (job, lambda) = (&row.job, row.sample.lambda);
        if let Some((last, before)) = &self.last
            && last.cmp(job).then_with(|| before.total_cmp(&lambda)) != Ordering::Less
        {
            refuse!("job {job}: lambda = {lambda} occurs twice; was the job collected twice?");
        }
        self.last = Some((job.clone(), lambda));
        Ok(())
    }

    /// The manifest of the rows, whose Parquet file has the given hash.
    pub(crate) fn manifest(self, hash: String, plan: &SplitPlan) -> Result<Manifest, DatasetError> {
        let no_rows = |rejected| DatasetError::from(fault!("no rows: {}", reasons(rejected)));
        let bent_rays = self.meshes.bent_rays.unwrap_or_default();
        let Some((rays, finer)) = self.meshes.sorted()? else {
            return Err(no_rows(&self.rejected));
        };
        let Some(domain) = TrainingDomain::covering(rays.states()) else {
            return Err(no_rows(&self.rejected));
        };
        let mut hinge = rays.first.design.constants();
        if domain.holes.is_some() {
            hinge.fillet_ratio = HingeConstants::PAPER.fillet_ratio;
        }
        let split = Split::deal(&rays.geometries, plan)?;
        let [material, material_hashes, gmsh, ccx] = self.texts;
        Ok(Manifest {
            format_version: FORMAT_VERSION,
            hash,
            units: COLUMNS
                .iter()
                .filter(|column| !column.unit.is_empty())
                .map(|column| (column.name.to_owned(), column.unit.to_owned()))
                .collect(),
            rows: self.rows,
            rays: rays.rays,
            partial_rays: rays.partial_rays,
            geometries: rays.geometries.len(),
            cpu_s: rays.cpu_s,
            bent_rays,
            finer: finer.map(|finer| FinerMesh {
                tier: finer.first.tier,
                rays: finer.rays,
                cpu_s: finer.cpu_s,
            }),
            gates: AcceptanceLimits::default(),
            rejected: self.rejected,
            material: Vec::from_iter(material).join(" + "),
            tier: rays.first.tier,
            hinge,
            material_hashes,
            settings_hashes: [rays.first.settings_hash].into(),
            gmsh,
            ccx,
            domain,
            split_plan: *plan,
            split_hash: split.hash(),
            split,
        })
    }
}

/// Why rows were rejected, with their numbers, or what to do where there were none.
fn reasons(rejected: &BTreeMap<Rejection, usize>) -> String {
    if rejected.is_empty() {
        return "run the campaign before collecting it".into();
    }
    let reasons = rejected.iter();
    let reasons: Vec<String> =
        reasons.map(|(reason, count)| format!("{count} were rejected since {reason}")).collect();
    reasons.join("; ")
}
