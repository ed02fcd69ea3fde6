//! Split into training, validation and test, by hinge geometry.
//!
//! All rays of one (w_lig, alpha) and of its mirror image belong to the same part. The test part
//! therefore contains only geometries that are not in the training part.

use fe_driver::SolvedRay;
use hinge::{HingeDesign, HingeSample};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{FRAC_PI_2, PI};
use support::{Fault, ensure};

/// How geometries are assigned to the parts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SplitPlan {
    /// Seed of the random order of the geometries.
    pub seed: u64,
    /// Fraction of the geometries used to choose the checkpoint, in (0, 1/2).
    pub validation: f64,
    /// Fraction of the geometries used to measure the published errors, in (0, 1/2).
    pub test: f64,
}

impl SplitPlan {
    /// All rays are of the test part: states on which weights are tested.
    pub const TEST: Self = Self { seed: 0, validation: 0.0, test: 1.0 };
}

impl Default for SplitPlan {
    fn default() -> Self {
        Self { seed: 0, validation: 0.1, test: 0.1 }
    }
}

/// A part of the database.
#[derive(Clone, Copy, Debug)]
pub enum Subset {
    /// Fits the weights.
    Training,
    /// Chooses the checkpoint.
    Validation,
    /// Measures the published errors.
    Test,
}

/// The ids of the jobs of each part, sorted.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Split {
    /// Jobs that fit the weights.
    pub training: BTreeSet<String>,
    /// Jobs that choose the checkpoint.
    pub validation: BTreeSet<String>,
    /// Jobs that measure the published errors.
    pub test: BTreeSet<String>,
}

impl Split {
    /// Assigns geometries at random; every part has at least one of them, unless all are to test.
    pub(crate) fn deal(geometries: &Geometries, plan: &SplitPlan) -> Result<Self, Fault> {
        if *plan == SplitPlan::TEST {
            let jobs = geometries.0.values().flatten().cloned();
            return Ok(Self { test: jobs.collect(), ..Self::default() });
        }
        let SplitPlan { validation, test, .. } = *plan;
        ensure!(
            [validation, test].iter().all(|share| (0.0..0.5).contains(share) && *share > 0.0),
            "the fractions validation = {validation} and test = {test} violate \
                 0 < fraction < 0.5"
        );
        let mut geometries: Vec<&Vec<String>> = geometries.0.values().collect();
        let count = geometries.len();
        ensure!(
            count >= 3,
            "{count} geometries cannot be split into training, validation and test: at least \
                 3 are needed"
        );
        geometries.shuffle(&mut ChaCha8Rng::seed_from_u64(plan.seed));
        // Rounding leaves every part at least one geometry.
        let share =
            |share: f64| ((share * count as f64).round() as usize).clamp(1, (count - 1) / 2);
        let mut take = |count: usize| geometries.drain(..count).flatten().cloned().collect();
        Ok(Self {
            validation: take(share(validation)),
            test: take(share(test)),
            training: geometries.into_iter().flatten().cloned().collect(),
        })
    }

    /// BLAKE3 of the three lists of jobs.
    pub(crate) fn hash(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        for (part, jobs) in [&self.training, &self.validation, &self.test].iter().enumerate() {
            for job in *jobs {
                hasher.update(format!("{part} {job}\n").as_bytes());
            }
        }
        hasher.finalize().to_hex().to_string()
    }

    /// The same split of some of the jobs.
    pub(crate) fn of(&self, jobs: BTreeSet<&String>) -> Self {
        let mut split = self.clone();
        for part in [&mut split.training, &mut split.validation, &mut split.test] {
            part.retain(|job| jobs.contains(job));
        }
        split
    }

    /// The ids of the jobs of one part.
    pub fn jobs(&self, part: Subset) -> &BTreeSet<String> {
        match part {
            Subset::Training => &self.training,
            Subset::Validation => &self.validation,
            Subset::Test => &self.test,
        }
    }
}

/// The ids of the jobs of each geometry.
#[derive(Default)]
pub(crate) struct Geometries(BTreeMap<[i64; 2], Vec<String>>);

impl Geometries {
    /// Adds the geometry and the job of a ray.
    pub(crate) fn add(&mut self, ray: &SolvedRay) {
        self.0.entry(geometry(&ray.design)).or_default().push(ray.job.clone());
    }

    /// Number of distinct (w_lig, alpha), up to mirroring.
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }
}

/// (w_lig, alpha) up to mirroring, in units of 1e-9, so the rounding error of pi - alpha has
/// no effect.
pub(crate) fn geometry(design: &HingeDesign) -> [i64; 2] {
    let alpha = design.alpha.min(PI - design.alpha);
    [design.w_lig, alpha].map(|value| (1e9 * value).round() as i64)
}

/// The geometry and (a, s, theta) up to mirroring, in units of 1e-9.
pub(crate) fn state(design: &HingeDesign, sample: &HingeSample) -> ([i64; 2], [i64; 3]) {
    let s = if design.alpha > FRAC_PI_2 { -sample.s } else { sample.s };
    let deformation = [sample.a, s, sample.theta];
    (geometry(design), deformation.map(|value| (1e9 * value).round() as i64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rays::tests::rays;
    use crate::rays::with_mirrored;
    use testkit::changed;

    fn geometries(rays: &[SolvedRay]) -> Geometries {
        let mut geometries = Geometries::default();
        rays.iter().for_each(|ray| geometries.add(ray));
        geometries
    }

    fn deal(rays: &[SolvedRay], seed: u64) -> Split {
        let plan = SplitPlan { seed, validation: 0.2, test: 0.3 };
        Split::deal(&geometries(rays), &plan).unwrap()
    }

    #[test]
    fn parts_are_disjoint_and_complete_and_have_the_requested_fractions() {
        let split = deal(&rays(20), 7);
        let counts =
            [Subset::Training, Subset::Validation, Subset::Test].map(|part| split.jobs(part).len());
        assert_eq!(counts, [10, 4, 6]);
        let all: BTreeSet<_> =
            split.training.iter().chain(&split.validation).chain(&split.test).collect();
        assert_eq!(all.len(), 20);
    }

    #[test]
    fn the_split_depends_on_the_seed() {
        let rays = rays(20);
        assert_eq!(deal(&rays, 7), deal(&rays, 7));
        assert_ne!(deal(&rays, 7), deal(&rays, 8));
    }

    #[test]
    fn rays_and_mirror_images_of_a_geometry_stay_together() {
        let images = with_mirrored(&rays(10)).split_off(10);
        let images = changed(images, |image| image.job.push_str("-image"));
        let split = deal(&[rays(10), images].concat(), 3);
        for part in [Subset::Training, Subset::Validation, Subset::Test] {
            for job in split.jobs(part) {
                let twin = job.strip_suffix("-image").map_or(format!("{job}-image"), Into::into);
                assert!(split.jobs(part).contains(&twin), "{job}");
            }
        }
    }

    #[test]
    fn too_few_geometries_and_impossible_fractions_are_rejected() {
        let plan = SplitPlan::default();
        let error = Split::deal(&geometries(&rays(2)), &plan).unwrap_err();
        assert!(error.to_string().starts_with("2 geometries"), "{error}");
        let tested = Split::deal(&geometries(&rays(1)), &SplitPlan::TEST).unwrap();
        assert_eq!([tested.training.len(), tested.validation.len(), tested.test.len()], [0, 0, 1]);
        let three = Split::deal(&geometries(&rays(3)), &plan).unwrap();
        assert_eq!(three.training.len(), 1);
        for (validation, test) in [(0.0, 0.1), (0.1, 0.5), (0.1, f64::NAN)] {
            let plan = SplitPlan { validation, test, ..plan };
            let error = Split::deal(&geometries(&rays(9)), &plan).unwrap_err();
            assert!(error.to_string().starts_with("the fractions"), "{error}");
        }
    }
}
