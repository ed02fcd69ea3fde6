//! Comparison of rays that were solved twice: the error of a mesh relative to a finer one, or of
//! one solver to another.
//!
//! Two jobs are the same ray if their designs, their ends and their material laws are the same. They
//! are compared at the states of the first job, up to the smaller lambda of the two; the second job
//! is interpolated linearly in lambda.

use crate::database::Database;
use crate::rows::{Fidelity, RayKey, Row, ray_key};
use hinge::HingeSample;
use std::array::from_fn;
use std::collections::BTreeMap;

/// The quantities that are compared.
pub const COMPARED: [&str; 6] = ["W", "F_a", "F_s", "M_theta", "D", "D_peak"];

/// One ray that both databases contain.
#[derive(Clone, Debug)]
pub struct ComparedRay<'a> {
    /// The rows of the compared database, in order of lambda, up to the last lambda of the
    /// reference; not empty.
    pub rows: &'a [Row],
    /// The sample of the reference database at each of these rows.
    pub references: Vec<HingeSample>,
    /// CPU time of the ray (s) in the compared database and in the reference database.
    pub cpu_s: [f64; 2],
}

impl<'a> ComparedRay<'a> {
    /// Each row with its reference sample.
    pub fn pairs(&self) -> impl Iterator<Item = (&'a Row, &HingeSample)> {
        std::iter::zip(self.rows, &self.references)
    }

    /// The state of each row with its reference.
    pub fn states(&self) -> Vec<ComparedState> {
        let states = self.pairs();
        states.map(|(row, reference)| ComparedState::new(&row.sample, reference)).collect()
    }
}

/// A state in both databases. Quantities unknown in one of them are NaN and are not counted.
#[derive(Clone, Copy, Debug)]
pub struct ComparedState {
    /// Values in the compared database, in the order of [`COMPARED`].
    pub value: [f64; 6],
    /// Values in the reference database.
    pub reference: [f64; 6],
}

impl ComparedState {
    /// The state in two samples, of the compared database and of the reference.
    pub fn new(value: &HingeSample, reference: &HingeSample) -> Self {
        let compared = |x: &HingeSample| {
            let peak = x.d_peak.unwrap_or(f64::NAN);
            [x.w, x.f_a, x.f_s, x.m_theta, x.d, peak]
        };
        Self { value: compared(value), reference: compared(reference) }
    }

    /// Whether the quantity `i` of [`COMPARED`] is known in both databases.
    pub fn is_known(&self, i: usize) -> bool {
        !(self.value[i] - self.reference[i]).is_nan()
    }
}

impl Database {
    /// The rays that were solved on the finer mesh too, each with its samples there.
    pub fn on_both_meshes(&self) -> Vec<ComparedRay<'_>> {
        let manifest = self.manifest();
        let finer = manifest.finer.as_ref();
        finer.map_or(Vec::new(), |finer| compare_meshes((self, manifest.tier), (self, finer.tier)))
    }
}

/// The rays that both databases contain, in the order of their designs; of a database with a finer
/// mesh, those on the other one.
pub fn compare<'a>(candidate: &'a Database, reference: &'a Database) -> Vec<ComparedRay<'a>> {
    let [candidate, reference] =
        [candidate, reference].map(|database| (database, database.manifest().tier));
    compare_meshes(candidate, reference)
}

fn compare_meshes<'a>(
    candidate: (&'a Database, Fidelity),
    reference: (&'a Database, Fidelity),
) -> Vec<ComparedRay<'a>> {
    let references = rays(reference);
    let compared = |(key, ray): (_, &'a [Row])| {
        let reference = *references.get(&key)?;
        let samples: Vec<_> = reference.iter().map(|row| row.sample).collect();
        let known = ray.iter().map_while(|row| HingeSample::at(&samples, row.sample.lambda));
        let references: Vec<HingeSample> = known.collect();
        let rows = &ray[..references.len()];
        Some(ComparedRay { cpu_s: [rows.first()?.cpu_s, reference[0].cpu_s], rows, references })
    };
    rays(candidate).into_iter().filter_map(compared).collect()
}

/// Root mean square of the reference values of each quantity.
pub fn reference_rms<'a>(states: impl IntoIterator<Item = &'a ComparedState>) -> [f64; 6] {
    rms(states, |state, i| state.reference[i])
}

/// Root mean square of the differences of each quantity, divided by the root mean square of the
/// references or by `minimum`, whichever is larger. The minimum keeps the relative error of a
/// nearly zero damage finite.
pub fn relative_rms(states: &[ComparedState], minimum: [f64; 6]) -> [f64; 6] {
    let off = rms(states, |state, i| state.value[i] - state.reference[i]);
    let scale = reference_rms(states);
    from_fn(|i| off[i] / scale[i].max(minimum[i]).max(f64::MIN_POSITIVE))
}

fn rms<'a>(
    states: impl IntoIterator<Item = &'a ComparedState>,
    part: impl Fn(&ComparedState, usize) -> f64,
) -> [f64; 6] {
    let (mut squares, mut counts) = ([0.0; 6], [0.0; 6]);
    for state in states {
        for i in 0..6 {
            if state.is_known(i) {
                squares[i] += part(state, i).powi(2);
                counts[i] += 1.0;
            }
        }
    }
    from_fn(|i| (squares[i] / f64::max(counts[i], 1.0)).sqrt())
}

/// The rays on a mesh, by ray and hash of the material law. The last row of a job identifies its
/// ray, which may bend.
fn rays((database, tier): (&Database, Fidelity)) -> BTreeMap<(RayKey, &str), &[Row]> {
    let rays = database.rays().into_iter().filter(|ray| ray[0].tier == tier);
    let keyed = rays.map(|ray| {
        let last = &ray[ray.len() - 1];
        ((ray_key(last), last.material_hash.as_str()), ray)
    });
    keyed.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::{finer, rows};
    use crate::split::SplitPlan;

    fn database(rows: Vec<Row>) -> Database {
        Database::collect(rows, &SplitPlan::default()).unwrap()
    }

    #[test]
    fn rays_scaled_by_three_percent_differ_by_three_percent() {
        let stiff = rows(6).into_iter().map(|row| {
            let x = row.sample;
            let (w, w_work) = (1.03 * x.w, 1.03 * x.w_work);
            let (f_a, f_s, m_theta) = (1.03 * x.f_a, 1.03 * x.f_s, 1.03 * x.m_theta);
            let (d, d_peak) = (1.03 * x.d, x.d_peak.map(|peak| 1.03 * peak));
            let sample = HingeSample { w, w_work, f_a, f_s, m_theta, d, d_peak, ..x };
            Row { sample, job: format!("stiff-{}", row.job), ..row }
        });
        let (candidate, reference) = (database(stiff.collect()), database(rows(6)));
        let rays = compare(&candidate, &reference);
        assert_eq!(rays.len(), 6);
        assert!(rays.iter().all(|ray| ray.rows[ray.rows.len() - 1].sample.lambda == 1.0));
        let states: Vec<_> = rays.iter().flat_map(ComparedRay::states).collect();
        for difference in relative_rms(&states, [0.0; 6]) {
            assert!((difference - 0.03).abs() < 1e-12, "{difference}");
        }
        let twice = reference_rms(&states).map(|rms| 2.0 * rms);
        for difference in relative_rms(&states, twice) {
            assert!((difference - 0.015).abs() < 1e-12, "{difference}");
        }
        // Only rays that both databases contain are compared.
        let fewer = database(rows(4));
        assert_eq!(compare(&candidate, &fewer).len(), 4);
    }

    #[test]
    fn rays_of_other_materials_are_not_compared() {
        let of = |law: &str| {
            let rows = rows(6).into_iter();
            let named = rows.map(|row| Row {
                job: format!("{law}-{}", row.job),
                material_hash: law.into(),
                ..row
            });
            database(named.collect())
        };
        let [film, steel] = ["f11f", "57ee1"].map(of);
        assert_eq!(compare(&film, &steel).len(), 0);
        assert_eq!(compare(&film, &film).len(), 6);
    }

    #[test]
    fn the_rays_of_both_meshes_are_compared_with_the_finer_one() {
        assert_eq!(database(rows(6)).on_both_meshes().len(), 0);
        let mut fine = finer(rows(4));
        fine.iter_mut().for_each(|row| row.cpu_s = 70.0);
        let both = database([rows(6), fine].concat());
        let rays = both.on_both_meshes();
        assert_eq!(rays.len(), 4);
        for ray in rays {
            assert!(ray.rows.iter().all(|row| row.tier == Fidelity::default()));
            assert_eq!((ray.rows.len(), ray.cpu_s), (10, [10.0, 70.0]));
        }
    }
}
