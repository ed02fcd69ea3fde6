//! What the manifest and the summary need of the rows of a database, gathered ray by ray: the rows themselves need not be
//! in memory at the same time.

use crate::error::DatasetError;
use crate::gates::{Gates, Rejection};
use crate::manifest::{FORMAT_VERSION, Manifest};
use crate::mixing::Mixing;
use crate::rows::Row;
use crate::schema;
use crate::split::{Geometries, Split, SplitPlan};
use hinge::{HingeConstants, HingeDeformation, HingeDesign, TrainingDomain};
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

/// The order of the rows of a database.
pub(crate) fn by_job_and_lambda(left: &Row, right: &Row) -> Ordering {
    let by_lambda = || left.sample.lambda.total_cmp(&right.sample.lambda);
    left.job.cmp(&right.job).then_with(by_lambda)
}

/// What is known of the rows so far.
pub(crate) struct Digest {
    mixing: Mixing,
    rejected: BTreeMap<Rejection, usize>,
    /// The first accepted row.
    first: Option<Row>,
    /// Job and lambda of the last accepted row.
    last: (String, f64),
    rays: usize,
    partial_rays: usize,
    cpu_s: f64,
    geometries: Geometries,
    /// The different values of every column of text, in the order of [`TEXTS`].
    texts: [BTreeSet<String>; TEXTS.len()],
    /// Designs, each with the number of successive rows that have it.
    designs: Vec<(HingeDesign, usize)>,
    deformations: Vec<HingeDeformation>,
}

/// The columns of text whose values the manifest lists.
const TEXTS: [fn(&Row) -> &String; 6] = [
    |row| &row.material,
    |row| &row.tier,
    |row| &row.material_hash,
    |row| &row.settings_hash,
    |row| &row.gmsh,
    |row| &row.ccx,
];

impl Digest {
    pub fn new(mixing: Mixing) -> Self {
        Self {
            mixing,
            rejected: BTreeMap::new(),
            first: None,
            last: (String::new(), f64::NEG_INFINITY),
            rays: 0,
            partial_rays: 0,
            cpu_s: 0.0,
            geometries: Geometries::default(),
            texts: Default::default(),
            designs: Vec::new(),
            deformations: Vec::new(),
        }
    }

    /// The rows that pass the gates; the others are counted.
    pub fn accepted(&mut self, mut rows: Vec<Row>) -> Vec<Row> {
        rows.retain(|row| match Gates::default().rejection(row) {
            Some(reason) => {
                *self.rejected.entry(reason).or_default() += 1;
                false
            }
            None => true,
        });
        rows
    }

    /// Adds accepted rows of one job, in the order of lambda. The jobs must come in the order of their ids.
    pub fn add(&mut self, ray: &[Row]) -> Result<(), DatasetError> {
        for row in ray {
            self.mixing.check(self.first.as_ref().unwrap_or(row), row)?;
            self.refuse_duplicate(row)?;
            self.geometries.add(row);
            for (values, text) in self.texts.iter_mut().zip(TEXTS) {
                if !values.contains(text(row)) {
                    values.insert(text(row).clone());
                }
            }
            match self.designs.last_mut() {
                Some((design, count)) if *design == row.design => *count += 1,
                _ => self.designs.push((row.design, 1)),
            }
            self.deformations.push(row.sample.deformation());
            if self.first.is_none() {
                self.first = Some(row.clone());
            }
        }
        if let Some(last) = ray.last() {
            self.rays += 1;
            self.partial_rays += usize::from(last.is_partial());
            self.cpu_s += last.cpu_s;
        }
        Ok(())
    }

    /// Rejects a row that does not come after the last one: one with the same job and lambda.
    fn refuse_duplicate(&mut self, row: &Row) -> Result<(), DatasetError> {
        let (job, lambda) = (&row.job, row.sample.lambda);
        let by_lambda = || self.last.1.total_cmp(&lambda);
        if self.last.0.cmp(job).then_with(by_lambda) != Ordering::Less {
            let job = job.clone();
            return Err(DatasetError::Duplicate { job, lambda });
        }
        self.last.0.clone_from(job);
        self.last.1 = lambda;
        Ok(())
    }

    /// The manifest of the rows, whose Parquet file has the given hash.
    pub fn manifest(self, hash: String, plan: &SplitPlan) -> Result<Manifest, DatasetError> {
        let designs =
            (self.designs.iter()).flat_map(|(design, count)| std::iter::repeat_n(*design, *count));
        let states = designs.zip(self.deformations.iter().copied());
        let domain = TrainingDomain::covering(states);
        let (Some(first), Some(domain)) = (self.first, domain) else {
            return Err(DatasetError::NoRows {
                why: reasons(&self.rejected),
            });
        };
        let mut hinge = first.design.constants();
        if domain.holes.is_some() {
            hinge.fillet_ratio = HingeConstants::PAPER.fillet_ratio;
        }
        let split = Split::deal(&self.geometries, plan)?;
        let joined = |values: BTreeSet<String>| Vec::from_iter(values).join(" + ");
        let [material, tier, material_hashes, settings_hashes, gmsh, ccx] = self.texts;
        Ok(Manifest {
            format_version: FORMAT_VERSION,
            hash,
            units: schema::units()
                .map(|(name, unit)| (name.to_owned(), unit.to_owned()))
                .collect(),
            rows: self.deformations.len(),
            rays: self.rays,
            partial_rays: self.partial_rays,
            geometries: self.geometries.len(),
            cpu_s: self.cpu_s,
            gates: Gates::default(),
            rejected: self.rejected,
            material: joined(material),
            tier: joined(tier),
            hinge,
            material_hashes,
            settings_hashes,
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
    let reasons: Vec<String> = reasons
        .map(|(reason, count)| format!("{count} were rejected since {reason}"))
        .collect();
    reasons.join("; ")
}
