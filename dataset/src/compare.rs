//! Comparison of rays that were solved twice: the error of a mesh relative to a finer one, or of
//! one solver to another.
//!
//! Two jobs are the same ray if their designs, their ends and their material laws are the same. They
//! are compared at the states of the first job, up to the smaller lambda of the two; the second job
//! is interpolated linearly in lambda.

use crate::database::Database;
use crate::rays::{RayKey, ray_key};
use fe_driver::{Fidelity, SolvedRay};
use hinge::HingeSample;
use std::array::from_fn;
use std::collections::BTreeMap;

/// The quantities that are compared.
pub const COMPARED: [&str; 6] = ["W", "F_a", "F_s", "M_theta", "D", "D_peak"];

/// One ray that both databases contain.
#[derive(Clone, Debug)]
pub struct ComparedRay<'a> {
    /// The ray in the compared database.
    pub ray: &'a SolvedRay,
    /// The sample of the reference database at each of its first samples, up to the last lambda
    /// there; not empty.
    pub references: Vec<HingeSample>,
    /// CPU time of the ray (s) in the reference database.
    pub reference_cpu_s: f64,
}

impl<'a> ComparedRay<'a> {
    /// Each sample with its reference.
    pub fn pairs(&self) -> impl Iterator<Item = (&'a HingeSample, &HingeSample)> {
        std::iter::zip(&self.ray.samples, &self.references)
    }

    /// The state of each sample with its reference.
    pub fn states(&self) -> Vec<ComparedState> {
        self.pairs().map(|(sample, reference)| ComparedState::new(sample, reference)).collect()
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
    let compared = |(key, ray): (_, &'a SolvedRay)| {
        let reference = references.get(&key)?;
        let known =
            ray.samples.iter().map_while(|it| HingeSample::at(&reference.samples, it.lambda));
        let references: Vec<HingeSample> = known.collect();
        let reference_cpu_s = reference.cpu_s;
        (!references.is_empty()).then_some(ComparedRay { ray, references, reference_cpu_s })
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

/// The rays on a mesh, by ray and hash of the material law.
fn rays((database, tier): (&Database, Fidelity)) -> BTreeMap<(Option<RayKey>, &str), &SolvedRay> {
    let rays = database.on_tier(tier);
    rays.map(|ray| ((ray_key(ray), ray.material_hash.as_str()), ray)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rays::tests::{finer, rays};
    use crate::split::SplitPlan;
    use testkit::changed;

    fn database(rays: Vec<SolvedRay>) -> Database {
        Database::collect(rays, &SplitPlan::default()).unwrap()
    }

    #[test]
    fn rays_scaled_by_three_percent_differ_by_three_percent() {
        let stiff = |x: &mut HingeSample| {
            for value in [&mut x.w, &mut x.w_work, &mut x.f_a, &mut x.f_s, &mut x.m_theta, &mut x.d]
            {
                *value *= 1.03;
            }
            x.d_peak = x.d_peak.map(|peak| 1.03 * peak);
        };
        let stiff = changed(rays(6), |ray| {
            ray.job = format!("stiff-{}", ray.job);
            ray.samples.iter_mut().for_each(stiff);
        });
        let (candidate, reference) = (database(stiff), database(rays(6)));
        let compared = compare(&candidate, &reference);
        assert_eq!(compared.len(), 6);
        assert!(compared.iter().all(|it| it.references[9].lambda == 1.0));
        let states: Vec<_> = compared.iter().flat_map(ComparedRay::states).collect();
        for difference in relative_rms(&states, [0.0; 6]) {
            assert!((difference - 0.03).abs() < 1e-12, "{difference}");
        }
        let twice = reference_rms(&states).map(|rms| 2.0 * rms);
        for difference in relative_rms(&states, twice) {
            assert!((difference - 0.015).abs() < 1e-12, "{difference}");
        }
        // Only rays that both databases contain are compared.
        let fewer = database(rays(4));
        assert_eq!(compare(&candidate, &fewer).len(), 4);
    }

    #[test]
    fn rays_of_other_materials_are_not_compared() {
        let of = |law: &str| {
            database(changed(rays(6), |ray| {
                ray.job = format!("{law}-{}", ray.job);
                ray.material_hash = law.into();
            }))
        };
        let [film, steel] = ["f11f", "57ee1"].map(of);
        assert_eq!(compare(&film, &steel).len(), 0);
        assert_eq!(compare(&film, &film).len(), 6);
    }

    #[test]
    fn the_rays_of_both_meshes_are_compared_with_the_finer_one() {
        assert_eq!(database(rays(6)).on_both_meshes().len(), 0);
        let fine = changed(finer(rays(4)), |ray| ray.cpu_s = 70.0);
        let both = database([rays(6), fine].concat());
        let compared = both.on_both_meshes();
        assert_eq!(compared.len(), 4);
        for ComparedRay { ray, references, reference_cpu_s } in compared {
            assert_eq!(ray.tier, Fidelity::default());
            assert_eq!((references.len(), ray.cpu_s, reference_cpu_s), (10, 10.0, 70.0));
        }
    }
}
