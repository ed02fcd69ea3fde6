//! What the manifest and the summary need of the rows of a database, gathered ray by ray: the rows
//! themselves need not be in memory at the same time.

use crate::manifest::{AcceptanceLimits, FORMAT_VERSION, FinerMesh, Manifest, Rejection};
use crate::rows::{RayKey, Row, ray_key};
use crate::schema::{COLUMNS, DatasetError};
use crate::split::{Geometries, Split, SplitPlan};
use hinge::{HingeConstants, HingeDeformation, HingeDesign, Regime, TrainingDomain};
use std::cmp::{Ordering, Reverse};
use std::collections::{BTreeMap, BTreeSet};
use support::{Joined, fault, refuse};

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
    let reason = |(reason, count)| format!("{count} were rejected since {reason}");
    rejected.iter().map(reason).joined("; ")
}

// The meshes of a database: the mesh of its rays, and the finer mesh on which some of them were
// solved too.
//
// All rows have one material, one kerf and one window radius, since a surrogate has no feature for
// them. The finer mesh is the one with fewer rays, or, of as many, with the longer solves.

/// The rows of one mesh.
#[derive(Default)]
pub(crate) struct MeshRows {
    /// The first of them.
    pub first: Row,
    keys: BTreeSet<RayKey>,
    pub rays: usize,
    pub partial_rays: usize,
    pub cpu_s: f64,
    pub geometries: Geometries,
    /// Designs, each with the number of successive rows that have it.
    designs: Vec<(HingeDesign, usize)>,
    deformations: Vec<HingeDeformation>,
}

impl MeshRows {
    fn add(&mut self, ray: &[Row]) {
        for row in ray {
            self.geometries.add(row);
            match self.designs.last_mut() {
                Some((design, count)) if *design == row.design => *count += 1,
                _ => self.designs.push((row.design, 1)),
            }
            self.deformations.push(row.sample.deformation());
        }
        if let Some(last) = ray.last() {
            self.keys.insert(ray_key(last));
            self.rays += 1;
            self.partial_rays += usize::from(last.failure.is_some());
            self.cpu_s += last.cpu_s;
        }
    }

    /// CPU time of a ray (s).
    fn cost(&self) -> f64 {
        self.cpu_s / self.rays as f64
    }

    /// The design and the deformation of every row.
    pub(crate) fn states(&self) -> impl Iterator<Item = (HingeDesign, HingeDeformation)> + Clone {
        let designs =
            (self.designs.iter()).flat_map(|(design, count)| std::iter::repeat_n(*design, *count));
        designs.zip(self.deformations.iter().copied())
    }
}

/// Whether a ray bends like the free turn of a plate; `None` if it turns too little to tell, or if
/// it is another path, on which theta does not grow in proportion. Both
/// ends of its rows lie on one line in (lambda, eta_a / lambda), whose slope is the curvature times
/// theta^2.
fn bends(ray: &[Row]) -> Option<bool> {
    const LEAST_TURN: f64 = 0.1; // rad
    let (first, last) = (&ray.first()?.sample, &ray.last()?.sample);
    let lambdas = last.lambda - first.lambda;
    let turn = last.theta / last.lambda;
    let off = first.theta - turn * first.lambda;
    if lambdas <= 0.0 || last.theta.abs() < LEAST_TURN || off.abs() > 1e-4 {
        return None;
    }
    let slope = (last.a / last.lambda - first.a / first.lambda) / lambdas / ray[0].design.w_lig;
    let [_, of_free_turn] = Regime::Plate.free_opening();
    Some(slope / (turn * turn.abs()) > 0.5 * of_free_turn)
}

/// The rows of all meshes.
#[derive(Default)]
pub(crate) struct Meshes {
    meshes: Vec<MeshRows>,
    /// [`Manifest::bent_rays`](crate::Manifest::bent_rays), once a ray that turns was added.
    pub bent_rays: Option<bool>,
}

impl Meshes {
    /// Adds accepted rows of one job.
    pub(crate) fn add(&mut self, ray: &[Row]) -> Result<(), DatasetError> {
        let Some(first) = ray.first() else {
            return Ok(());
        };
        let known = self.meshes.iter().position(|mesh| mesh.first.tier == first.tier);
        let place = known.unwrap_or_else(|| {
            self.meshes.push(MeshRows { first: first.clone(), ..MeshRows::default() });
            self.meshes.len() - 1
        });
        for row in ray {
            refuse_other(&self.meshes[0].first, row, &SHARED)?;
            refuse_other(&self.meshes[place].first, row, &SHARED_ON_A_MESH)?;
        }
        if let Some(bent) = bends(ray)
            && bent != *self.bent_rays.get_or_insert(bent)
        {
            let shape = |bent| format!("of {} rays", if bent { "bent" } else { "straight" });
            return Err(mixed("a", first, [!bent, bent].map(shape)));
        }
        self.meshes[place].add(ray);
        Ok(())
    }

    /// The mesh of the rays, and the finer one if there is one; `None` without rows.
    pub(crate) fn sorted(self) -> Result<Option<(MeshRows, Option<MeshRows>)>, DatasetError> {
        let mut meshes = self.meshes;
        meshes.sort_by(|x, y| x.cost().total_cmp(&y.cost()));
        meshes.sort_by_key(|mesh| Reverse(mesh.keys.len()));
        let mut meshes = meshes.into_iter();
        let Some(rays) = meshes.next() else {
            return Ok(None);
        };
        let finer = meshes.next();
        let is_other = |mesh: &&MeshRows| {
            mesh.keys.is_disjoint(&rays.keys)
                || (mesh.keys.len() == rays.keys.len() && mesh.cost() <= rays.cost())
        };
        let third = meshes.next();
        match third.as_ref().or(finer.as_ref().filter(is_other)) {
            Some(MeshRows { first, .. }) => {
                Err(mixed("tier", first, [&rays.first, first].map(|row| row.tier.to_string())))
            }
            None => Ok(Some((rays, finer))),
        }
    }
}

/// A quantity of a row as text.
type RowQuantity = (&'static str, fn(&Row) -> String);

/// The quantities that all rows have in common.
const SHARED: [RowQuantity; 4] = [
    ("material", |row| row.material.clone()),
    ("material_hash", |row| row.material_hash.clone()),
    ("kerf", |row| format!("{} mm", row.design.kerf)),
    ("r_win", |row| format!("{} mm", row.design.r_win)),
];

/// The quantities that all rows of one mesh have in common.
const SHARED_ON_A_MESH: [RowQuantity; 2] =
    [("settings_hash", |row| row.settings_hash.clone()), ("tier", |row| row.tier.to_string())];

/// Rejects a row that differs from `first` in one of the quantities, which are not features of the
/// surrogate.
fn refuse_other(first: &Row, row: &Row, quantities: &[RowQuantity]) -> Result<(), DatasetError> {
    let mut different = quantities.iter().filter(|(_, text)| text(first) != text(row));
    match different.next() {
        Some((column, text)) => Err(mixed(column, row, [first, row].map(text))),
        None => Ok(()),
    }
}

fn mixed(column: &str, Row { job, .. }: &Row, [expected, found]: [String; 2]) -> DatasetError {
    fault!(
        "job {job}: {column} = {found}, but other rows have {expected}; collect them in separate \
         databases"
    )
    .into()
}
