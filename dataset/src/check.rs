//! Checks of a database that is readable and consistent with its manifest, but may be false.

use crate::database::Database;
use crate::rows::Row;
use crate::split::{Subset, geometry, state};
use std::collections::{BTreeMap, BTreeSet};

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
        let rows = self.rows();
        let row_findings = [
            ("the energy is negative", rows.iter().filter(|row| row.sample.w < 0.0).collect()),
            ("the same state of the same hinge occurs in two rays", repeated(rows)),
            (LEAK, self.leaked()),
        ];
        let ray_findings = [
            ("a damage decreases along a ray", with(&rays, healing)),
            ("a ray has a single state", with(&rays, |ray| ray.len() < 2)),
        ];
        let found = row_findings.into_iter().chain(ray_findings);
        let mut findings: Vec<Defect> = found.filter_map(finding).collect();
        findings.extend(forces_without_work(&rays));
        findings
    }

    /// A geometry of the test or validation part that occurs in the training part: the errors of
    /// weights would be false.
    pub fn leak(&self) -> Option<Defect> {
        finding((LEAK, self.leaked()))
    }

    /// One row per held-out ray whose geometry is one of the training rays.
    fn leaked(&self) -> Vec<&Row> {
        let split = &self.manifest().split;
        let trained = self.geometries(Subset::Training);
        let mut jobs = BTreeSet::new();
        let held_out =
            |row: &&Row| split.validation.contains(&row.job) || split.test.contains(&row.job);
        (self.rows().iter().filter(held_out))
            .filter(|row| trained.contains(&geometry(row)) && jobs.insert(&row.job))
            .collect()
    }
}

fn finding((what, rows): (&'static str, Vec<&Row>)) -> Option<Defect> {
    let first = rows.first()?;
    Some(Defect { what, count: rows.len(), job: first.job.clone() })
}

/// The first row of each ray that satisfies a condition.
fn with<'a>(rays: &[&'a [Row]], condition: fn(&[Row]) -> bool) -> Vec<&'a Row> {
    let rays = rays.iter().filter(|ray| condition(ray));
    rays.map(|ray| &ray[0]).collect()
}

/// Rows whose state, up to mirroring, occurs in an earlier ray of the same mesh and material law.
pub(crate) fn repeated(rows: &[Row]) -> Vec<&Row> {
    let mut seen: BTreeMap<_, &str> = BTreeMap::new();
    let earlier = rows.iter().filter(|row| {
        let solved = (state(row), row.tier, &row.material_hash);
        *seen.entry(solved).or_insert(&row.job) != row.job
    });
    earlier.collect()
}

/// Whether the plastic strain recedes by more than its noise.
fn healing(ray: &[Row]) -> bool {
    let maximum = ray.iter().map(|row| row.sample.d).fold(0.0, f64::max);
    ray.windows(2).any(|pair| pair[1].sample.d < pair[0].sample.d - 1e-3 * maximum)
}

/// The energies of the rays against the work of their forces (trapezoidal rule from the undeformed
/// state).
fn forces_without_work(rays: &[&[Row]]) -> Option<Defect> {
    let relative = |ray: &[Row]| -> Option<f64> {
        let last = ray.last().filter(|last| ray.len() > 4 && last.sample.w > 0.0)?;
        let (mut work, mut before) = (0.0, [[0.0; 3]; 2]);
        for Row { sample, .. } in ray {
            let (state, forces) = (sample.deformation().to_array(), sample.forces());
            work += (0..3)
                .map(|c| 0.5 * (forces[c] + before[1][c]) * (state[c] - before[0][c]))
                .sum::<f64>();
            before = [state, forces];
        }
        Some((work / last.sample.w - 1.0).abs())
    };
    let errors: Vec<(f64, &Row)> =
        rays.iter().filter_map(|ray| Some((relative(ray)?, &ray[0]))).collect();
    let mut sorted: Vec<f64> = errors.iter().map(|(error, _)| *error).collect();
    sorted.sort_by(f64::total_cmp);
    // The median: single rays may snap between two rows.
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
    use crate::rows::Fidelity;
    use crate::rows::tests::rows;
    use crate::split::SplitPlan;
    use mesher::Tier;

    fn found(change: impl Fn(&mut Vec<Row>)) -> Vec<&'static str> {
        let mut rows = rows(12);
        change(&mut rows);
        let database = Database::collect(rows, &SplitPlan::default());
        database.unwrap().check().into_iter().map(|it| it.what).collect()
    }

    #[test]
    fn a_sound_database_has_no_findings() {
        assert_eq!(found(|_| ()), Vec::<&str>::new());
    }

    #[test]
    fn a_state_is_repeated_only_within_one_mesh_and_material() {
        let other = |change: fn(&mut Row)| {
            let mut both = rows(12);
            for mut row in rows(12) {
                row.job = format!("other-{}", row.job);
                change(&mut row);
                both.push(row);
            }
            repeated(&both).len()
        };
        assert_eq!(other(|_| ()), rows(12).len());
        assert_eq!(other(|row| row.tier = Fidelity::Solved(Tier::Fine)), 0);
        assert_eq!(other(|row| row.material_hash = "57ee1".into()), 0);
    }

    #[test]
    fn false_tables_are_found() {
        let says = |change: &dyn Fn(&mut Vec<Row>), part: &str| {
            let found = found(change);
            assert!(found.iter().any(|what| what.contains(part)), "{part}: {found:?}");
        };
        // Such a row is rejected at collection; a table may have been written by other means.
        let mut database = Database::collect(rows(12), &SplitPlan::default()).unwrap();
        database.rows[7].sample.w = -1.0;
        assert!(database.check().iter().any(|it| it.what.contains("negative")));
        says(&|rows| rows.iter_mut().for_each(|row| row.sample.m_theta *= 57.3), "gradient");
        says(&|rows| rows[5].sample.d = 1.0, "decreases");
        says(
            &|rows| {
                let copy = rows[3].clone();
                rows.push(Row { job: "job-900".into(), ..copy });
            },
            "two rays",
        );
    }

    #[test]
    fn a_test_geometry_that_was_trained_on_is_found() {
        let plan = SplitPlan::default();
        let mut database = Database::collect(rows(12), &plan).unwrap();
        assert_eq!(database.leak(), None);
        let split = &mut database.manifest.split;
        let job = split.test.first().unwrap().clone();
        // The same geometry under another name in the training part.
        let mut copies: Vec<Row> =
            database.rows.iter().filter(|row| row.job == job).cloned().collect();
        copies.iter_mut().for_each(|row| row.job = "job-900".into());
        split.training.insert("job-900".into());
        database.rows.extend(copies);
        let found = database.check();
        assert!(found.iter().any(|it| it.what.contains("training part")), "{found:?}");
        assert!(found.contains(&database.leak().unwrap()));
    }
}
