//! The meshes of a database: the mesh of its rays, and the finer mesh on which some of them were
//! solved too.
//!
//! All rows have one material, one kerf and one window radius, since a surrogate has no feature for
//! them. The finer mesh is the one with fewer rays, or, of as many, with the longer solves.

use crate::error::DatasetError;
use crate::rows::{RayKey, Row, ray_key};
use crate::split::Geometries;
use hinge::{HingeDeformation, HingeDesign, Regime};
use std::cmp::Reverse;
use std::collections::BTreeSet;
use support::fault;

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

/// Whether a ray bends like the free turn of a plate; `None` if it turns too little to tell. Both
/// ends of its rows lie on one line in (lambda, eta_a / lambda), whose slope is the curvature times
/// theta^2.
fn bends(ray: &[Row]) -> Option<bool> {
    const LEAST_TURN: f64 = 0.1; // rad
    let (first, last) = (&ray.first()?.sample, &ray.last()?.sample);
    let lambdas = last.lambda - first.lambda;
    if lambdas <= 0.0 || last.theta.abs() < LEAST_TURN {
        return None;
    }
    let slope = (last.a / last.lambda - first.a / first.lambda) / lambdas / ray[0].design.w_lig;
    let turn = last.theta / last.lambda;
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
type Quantity = (&'static str, fn(&Row) -> String);

/// The quantities that all rows have in common.
const SHARED: [Quantity; 4] = [
    ("material", |row| row.material.clone()),
    ("material_hash", |row| row.material_hash.clone()),
    ("kerf", |row| format!("{} mm", row.design.kerf)),
    ("r_win", |row| format!("{} mm", row.design.r_win)),
];

/// The quantities that all rows of one mesh have in common.
const SHARED_ON_A_MESH: [Quantity; 2] =
    [("settings_hash", |row| row.settings_hash.clone()), ("tier", |row| row.tier.to_string())];

/// Rejects a row that differs from `first` in one of the quantities, which are not features of the
/// surrogate.
fn refuse_other(first: &Row, row: &Row, quantities: &[Quantity]) -> Result<(), DatasetError> {
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
