//! What the manifest and the summary need of the rays of a database, gathered one after the other:
//! the rays themselves need not be in memory at the same time.

use crate::manifest::{AcceptanceLimits, FORMAT_VERSION, FinerMesh, Manifest, Rejection};
use crate::rays::{RayKey, ray_key};
use crate::schema::COLUMNS;
use crate::split::{Geometries, Split, SplitPlan};
use fe_driver::SolvedRay;
use hinge::{HingeConstants, HingeDeformation, HingeDesign, HingeSample, Regime, TrainingDomain};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};
use support::{Fault, Joined, fault, refuse};

/// What is known of the rays so far.
#[derive(Default)]
pub(crate) struct Digest {
    rejected: BTreeMap<Rejection, usize>,
    /// Job of the last ray.
    last: Option<String>,
    rows: usize,
    meshes: Meshes,
    /// The different values of every column of text, in the order of [`TEXTS`].
    texts: [BTreeSet<String>; TEXTS.len()],
}

/// The columns of text whose values the manifest lists.
const TEXTS: [fn(&SolvedRay) -> &String; 4] =
    [|ray| &ray.material, |ray| &ray.material_hash, |ray| &ray.tools.gmsh, |ray| &ray.tools.ccx];

impl Digest {
    /// The ray with the samples within the acceptance limits, in the order of lambda; the others
    /// are counted.
    pub(crate) fn accepted(&mut self, mut ray: SolvedRay) -> SolvedRay {
        let mut samples = std::mem::take(&mut ray.samples);
        samples.retain(|sample| match AcceptanceLimits::default().rejection(&ray, sample) {
            Some(reason) => {
                *self.rejected.entry(reason).or_default() += 1;
                false
            }
            None => true,
        });
        samples.sort_by(|left, right| left.lambda.total_cmp(&right.lambda));
        SolvedRay { samples, ..ray }
    }

    /// Adds an accepted ray, which has samples. The rays must come in the order of their jobs.
    pub(crate) fn add(&mut self, ray: &SolvedRay) -> Result<(), Fault> {
        let SolvedRay { job, samples, .. } = ray;
        if self.last.as_ref().is_some_and(|last| last >= job) {
            refuse!("job {job} occurs twice; was it collected twice?");
        }
        if let Some(pair) = samples.windows(2).find(|pair| pair[0].lambda == pair[1].lambda) {
            refuse!("job {job}: lambda = {} occurs twice", pair[0].lambda);
        }
        for (values, text) in self.texts.iter_mut().zip(TEXTS) {
            if !values.contains(text(ray)) {
                values.insert(text(ray).clone());
            }
        }
        self.last = Some(job.clone());
        self.rows += samples.len();
        self.meshes.add(ray)
    }

    /// The manifest of the rays, whose Parquet file has the given hash.
    pub(crate) fn manifest(self, hash: String, plan: &SplitPlan) -> Result<Manifest, Fault> {
        let no_rows = || fault!("no rows: {}", reasons(&self.rejected));
        let bent_rays = self.meshes.bent_rays.unwrap_or_default();
        let (rays, finer) = self.meshes.sorted()?.ok_or_else(no_rows)?;
        let domain = TrainingDomain::covering(rays.states()).ok_or_else(no_rows)?;
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
// All rays have one material, one kerf and one window radius, since a surrogate has no feature for
// them. The finer mesh is the one with fewer rays, or, of as many, with the longer solves.

/// The rays of one mesh.
#[derive(Default)]
pub(crate) struct MeshRays {
    /// The first of them.
    pub first: SolvedRay,
    keys: BTreeSet<Option<RayKey>>,
    pub rays: usize,
    pub partial_rays: usize,
    pub cpu_s: f64,
    pub geometries: Geometries,
    /// Design of every ray, and number of its samples.
    designs: Vec<(HingeDesign, usize)>,
    deformations: Vec<HingeDeformation>,
}

impl MeshRays {
    fn add(&mut self, ray: &SolvedRay) {
        self.geometries.add(ray);
        self.designs.push((ray.design, ray.samples.len()));
        self.deformations.extend(ray.samples.iter().map(HingeSample::deformation));
        self.keys.insert(ray_key(ray));
        self.rays += 1;
        self.partial_rays += usize::from(ray.failure.is_some());
        self.cpu_s += ray.cpu_s;
    }

    /// CPU time of a ray (s).
    fn cost(&self) -> f64 {
        self.cpu_s / self.rays as f64
    }

    /// The design and the deformation of every sample.
    pub(crate) fn states(&self) -> impl Iterator<Item = (HingeDesign, HingeDeformation)> + Clone {
        let designs =
            (self.designs.iter()).flat_map(|(design, count)| std::iter::repeat_n(*design, *count));
        designs.zip(self.deformations.iter().copied())
    }
}

/// Whether a ray bends like the free turn of a plate; `None` if it turns too little to tell, or if
/// it is another path, on which theta does not grow in proportion. Both
/// ends of its samples lie on one line in (lambda, eta_a / lambda), whose slope is the curvature times
/// theta^2.
fn bends(ray: &SolvedRay) -> Option<bool> {
    const LEAST_TURN: f64 = 0.1; // rad
    let (first, last) = (ray.samples.first()?, ray.samples.last()?);
    let lambdas = last.lambda - first.lambda;
    let turn = last.theta / last.lambda;
    let off = first.theta - turn * first.lambda;
    if lambdas <= 0.0 || last.theta.abs() < LEAST_TURN || off.abs() > 1e-4 {
        return None;
    }
    let slope = (last.a / last.lambda - first.a / first.lambda) / lambdas / ray.design.w_lig;
    let [_, of_free_turn] = Regime::Plate.free_opening();
    Some(slope / (turn * turn.abs()) > 0.5 * of_free_turn)
}

/// The rays of all meshes.
#[derive(Default)]
pub(crate) struct Meshes {
    meshes: Vec<MeshRays>,
    /// [`Manifest::bent_rays`](crate::Manifest::bent_rays), once a ray that turns was added.
    pub bent_rays: Option<bool>,
}

impl Meshes {
    /// Adds an accepted ray.
    pub(crate) fn add(&mut self, ray: &SolvedRay) -> Result<(), Fault> {
        let known = self.meshes.iter().position(|mesh| mesh.first.tier == ray.tier);
        let place = known.unwrap_or_else(|| {
            self.meshes.push(MeshRays { first: ray.clone(), ..MeshRays::default() });
            self.meshes.len() - 1
        });
        refuse_other(&self.meshes[0].first, ray, &SHARED)?;
        refuse_other(&self.meshes[place].first, ray, &SHARED_ON_A_MESH)?;
        if let Some(bent) = bends(ray)
            && bent != *self.bent_rays.get_or_insert(bent)
        {
            let shape = |bent| format!("of {} rays", if bent { "bent" } else { "straight" });
            return Err(mixed("a", ray, [!bent, bent].map(shape)));
        }
        self.meshes[place].add(ray);
        Ok(())
    }

    /// The mesh of the rays, and the finer one if there is one; `None` without rows.
    pub(crate) fn sorted(self) -> Result<Option<(MeshRays, Option<MeshRays>)>, Fault> {
        let mut meshes = self.meshes;
        meshes.sort_by(|x, y| x.cost().total_cmp(&y.cost()));
        meshes.sort_by_key(|mesh| Reverse(mesh.keys.len()));
        let mut meshes = meshes.into_iter();
        let Some(rays) = meshes.next() else {
            return Ok(None);
        };
        let finer = meshes.next();
        let is_other = |mesh: &&MeshRays| {
            mesh.keys.is_disjoint(&rays.keys)
                || (mesh.keys.len() == rays.keys.len() && mesh.cost() <= rays.cost())
        };
        let third = meshes.next();
        match third.as_ref().or(finer.as_ref().filter(is_other)) {
            Some(MeshRays { first, .. }) => {
                Err(mixed("tier", first, [&rays.first, first].map(|ray| ray.tier.to_string())))
            }
            None => Ok(Some((rays, finer))),
        }
    }
}

/// A quantity of a ray as text.
type RayQuantity = (&'static str, fn(&SolvedRay) -> String);

/// The quantities that all rays have in common.
const SHARED: [RayQuantity; 4] = [
    ("material", |ray| ray.material.clone()),
    ("material_hash", |ray| ray.material_hash.clone()),
    ("kerf", |ray| format!("{} mm", ray.design.kerf)),
    ("r_win", |ray| format!("{} mm", ray.design.r_win)),
];

/// The quantities that all rays of one mesh have in common.
const SHARED_ON_A_MESH: [RayQuantity; 2] =
    [("settings_hash", |ray| ray.settings_hash.clone()), ("tier", |ray| ray.tier.to_string())];

/// Rejects a ray that differs from `first` in one of the quantities, which are not features of the
/// surrogate.
fn refuse_other(
    first: &SolvedRay,
    ray: &SolvedRay,
    quantities: &[RayQuantity],
) -> Result<(), Fault> {
    let mut different = quantities.iter().filter(|(_, text)| text(first) != text(ray));
    match different.next() {
        Some((column, text)) => Err(mixed(column, ray, [first, ray].map(text))),
        None => Ok(()),
    }
}

fn mixed(column: &str, ray: &SolvedRay, [expected, found]: [String; 2]) -> Fault {
    fault!(
        "job {}: {column} = {found}, but other rays have {expected}; collect them in separate \
         databases",
        ray.job
    )
}
