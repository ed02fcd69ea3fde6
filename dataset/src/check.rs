//! Checks of a database that is readable and consistent with its manifest, but may be false.

use crate::database::Database;
use crate::rays::samples;
use crate::split::{Subset, geometry, state};
use fe_driver::SolvedRay;
use hinge::HingeSample;
use std::collections::BTreeMap;

/// Maximum difference between the energy of a ray and the work of its forces, relative to the
/// energy, as the root mean square over the rays. Increments of a campaign leave 1 %; a wrong unit
/// or sign of a force leaves more than half.
const WORK: f64 = 0.2;

const LEAK: &str = "a geometry of the test or validation part occurs in the training part";

/// Something that makes a database unfit for training.
#[derive(Debug, PartialEq, thiserror::Error)]
#[error("{what} ({count} times, for example job {job})")]
pub struct Defect {
    /// What is wrong, in one sentence.
    pub what: &'static str,
    /// Number of rows or rays.
    pub count: usize,
    /// Job of one of them.
    pub job: String,
}

impl Database {
    /// Everything that is wrong with the database; empty if nothing was found.
    pub fn check(&self) -> Vec<Defect> {
        let rays = self.rays();
        let negative = samples(rays).filter(|(_, sample)| sample.w < 0.0).map(|(ray, _)| ray);
        let with = |condition: fn(&[HingeSample]) -> bool| {
            rays.iter().filter(move |ray| condition(&ray.samples)).collect()
        };
        let found = [
            ("the energy is negative", negative.collect()),
            ("the same state of the same hinge occurs in two rays", repeated(rays)),
            (LEAK, self.leaked()),
            ("a damage decreases along a ray", with(healing)),
            ("a ray has a single state", with(|samples| samples.len() < 2)),
        ];
        let mut findings: Vec<Defect> = found.into_iter().filter_map(finding).collect();
        findings.extend(forces_without_work(rays));
        findings
    }

    /// A geometry of the test or validation part that occurs in the training part: the errors of
    /// weights would be false.
    pub fn leak(&self) -> Option<Defect> {
        finding((LEAK, self.leaked()))
    }

    /// The held-out rays whose geometry is one of the training rays.
    fn leaked(&self) -> Vec<&SolvedRay> {
        let split = &self.manifest().split;
        let trained = self.geometries(Subset::Training);
        let is_held_out = |job| split.validation.contains(job) || split.test.contains(job);
        let held_out = self.rays().iter().filter(|ray| is_held_out(&ray.job));
        held_out.filter(|ray| trained.contains(&geometry(&ray.design))).collect()
    }
}

/// A defect of rays, one of which may be there several times.
fn finding((what, rays): (&'static str, Vec<&SolvedRay>)) -> Option<Defect> {
    let first = rays.first()?;
    Some(Defect { what, count: rays.len(), job: first.job.clone() })
}

/// The ray of every sample whose state, up to mirroring, occurs in an earlier ray of the same mesh
/// and material law.
pub(crate) fn repeated(rays: &[SolvedRay]) -> Vec<&SolvedRay> {
    let mut seen: BTreeMap<_, &str> = BTreeMap::new();
    let earlier = samples(rays).filter(|(ray, sample)| {
        let solved = (state(&ray.design, sample), ray.tier, &ray.material_hash);
        *seen.entry(solved).or_insert(&ray.job) != ray.job
    });
    earlier.map(|(ray, _)| ray).collect()
}

/// Whether the plastic strain recedes by more than its noise.
fn healing(samples: &[HingeSample]) -> bool {
    let maximum = samples.iter().map(|sample| sample.d).fold(0.0, f64::max);
    samples.windows(2).any(|pair| pair[1].d < pair[0].d - 1e-3 * maximum)
}

/// The energies of the rays against the work of their forces (trapezoidal rule from the undeformed
/// state).
fn forces_without_work(rays: &[SolvedRay]) -> Option<Defect> {
    let relative = |samples: &[HingeSample]| -> Option<f64> {
        let last = samples.last().filter(|last| samples.len() > 4 && last.w > 0.0)?;
        let (mut work, mut before) = (0.0, [[0.0; 3]; 2]);
        for sample in samples {
            let (state, forces) = (sample.deformation().to_array(), sample.forces());
            work += (0..3)
                .map(|c| 0.5 * (forces[c] + before[1][c]) * (state[c] - before[0][c]))
                .sum::<f64>();
            before = [state, forces];
        }
        Some((work / last.w - 1.0).abs())
    };
    let errors: Vec<(f64, &SolvedRay)> =
        rays.iter().filter_map(|ray| Some((relative(&ray.samples)?, ray))).collect();
    let mut sorted: Vec<f64> = errors.iter().map(|(error, _)| *error).collect();
    sorted.sort_by(f64::total_cmp);
    // The median: single rays may snap between two samples.
    let typical = *sorted.get(sorted.len() / 2)?;
    (typical > WORK).then(|| Defect {
        what: "the forces are not the gradient of the energy along the rays: check signs and units",
        count: errors.iter().filter(|(error, _)| *error > WORK).count(),
        job: errors[0].1.job.clone(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rays::tests::{ray, rays};
    use crate::split::SplitPlan;
    use fe_driver::Fidelity;
    use mesher::Tier;
    use testkit::changed;

    fn found(change: impl Fn(&mut Vec<SolvedRay>)) -> Vec<&'static str> {
        let mut rays = rays(12);
        change(&mut rays);
        let database = Database::collect(rays, &SplitPlan::default());
        database.unwrap().check().into_iter().map(|it| it.what).collect()
    }

    #[test]
    fn a_state_is_repeated_only_within_one_mesh_and_material() {
        let other = |change: fn(&mut SolvedRay)| {
            let others = changed(rays(12), |ray| {
                ray.job = format!("other-{}", ray.job);
                change(ray);
            });
            repeated(&[rays(12), others].concat()).len()
        };
        assert_eq!(other(|_| ()), samples(&rays(12)).count());
        assert_eq!(other(|ray| ray.tier = Fidelity::Solved(Tier::Fine)), 0);
        assert_eq!(other(|ray| ray.material_hash = "57ee1".into()), 0);
    }

    #[test]
    fn false_tables_are_found() {
        let says = |change: &dyn Fn(&mut Vec<SolvedRay>), part: &str| {
            let found = found(change);
            assert!(found.iter().any(|what| what.contains(part)), "{part}: {found:?}");
        };
        assert_eq!(found(|_| ()), Vec::<&str>::new());
        // Such a row is rejected at collection; a table may have been written by other means.
        let mut database = Database::collect(rays(12), &SplitPlan::default()).unwrap();
        database.rays[0].samples[7].w = -1.0;
        assert!(database.check().iter().any(|it| it.what.contains("negative")));
        let in_degrees =
            |ray: &mut SolvedRay| ray.samples.iter_mut().for_each(|x| x.m_theta *= 57.3);
        says(&|rays| rays.iter_mut().for_each(in_degrees), "gradient");
        says(&|rays| rays[0].samples[5].d = 1.0, "decreases");
        says(&|rays| rays[4].samples.truncate(1), "single state");
        let copy = || SolvedRay { job: "job-900".into(), ..ray(0) };
        says(&|rays| rays.push(copy()), "two rays");
    }

    #[test]
    fn a_test_geometry_that_was_trained_on_is_found() {
        let plan = SplitPlan::default();
        let mut database = Database::collect(rays(12), &plan).unwrap();
        assert_eq!(database.leak(), None);
        let split = &mut database.manifest.split;
        let job = split.test.first().unwrap().clone();
        // The same geometry under another name in the training part.
        let copy = database.rays.iter().find(|ray| ray.job == job).unwrap().clone();
        split.training.insert("job-900".into());
        database.rays.push(SolvedRay { job: "job-900".into(), ..copy });
        let found = database.check();
        assert!(found.iter().any(|it| it.what.contains("training part")), "{found:?}");
        assert!(found.contains(&database.leak().unwrap()));
    }
}
