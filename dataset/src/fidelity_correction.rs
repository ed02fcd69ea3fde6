//! Correction of the mesh error of a database: a multiplicative bridge between two fidelities,
//! fitted to the few rays that were also solved on a finer mesh,
//!
//! ```text
//! W' = (1 + q) W,     F' = dW'/d(a, s, theta) = (1 + q) F + W dq/d(a, s, theta),     q = c . terms
//! ```
//!
//! with a separate q for each damage measure. The terms are the monomials of degree two or less in
//! w_lig, alpha - pi/2, eta_a, eta_s and theta, each divided by its range, that satisfy the mirror
//! symmetry. Outside the range of the rays on both meshes, q is constant in that coordinate. c is
//! fitted to the energy and its forces, which are linear in it, by least squares of the relative
//! errors; the corrected forces remain the gradient of the corrected energy. W with its forces, D
//! or D_peak remains uncorrected if the sum of its squared errors over all rays, each corrected by
//! the others, is no smaller than without the correction; of W and its forces, the sum of the four
//! relative errors. (Fernandez-Godino et al., "Review of multi-fidelity models", 2016, section 2.)

use crate::bridge::{Bridge, TERMS};
use crate::compare::{COMPARED, ComparedRay, ComparedState};
use crate::database::Database;
use fe_driver::{Fidelity, SolvedRay};
use hinge::HingeSample;
use support::{Fault, refuse};

impl Database {
    /// The rays, corrected to the finer mesh by those that were solved on it too, but for
    /// quantities that [`left_out`] leaves uncorrected; without a correction of W the tier remains.
    /// The rays of the finer mesh are left out. Returns the validation too; `None`, and the
    /// database as it is, if no ray was solved on a finer mesh.
    pub fn corrected(self) -> Result<(Self, Option<LeftOut>), Fault> {
        let Some(finer) = &self.manifest().finer else {
            return Ok((self, None));
        };
        let rays = self.on_both_meshes();
        let checked = left_out(&rays)?;
        let corrected = checked.corrected();
        let from = self.manifest().tier;
        let tier = if corrected[0] {
            Fidelity::Corrected { from: from.mesh(), to: finer.tier.mesh() }
        } else {
            from
        };
        let bridge = Bridge::fit(&rays).only(corrected);
        let corrected = |ray: &SolvedRay| {
            let samples = ray.samples.iter().map(|sample| bridge.corrected(ray, sample)).collect();
            SolvedRay { samples, tier, ..ray.clone() }
        };
        let rays = self.on_tier(from).map(corrected).collect();
        Ok((self.with_rays(rays)?, Some(checked)))
    }
}

/// Positions of the quantities with a correction of their own in [`COMPARED`].
const CORRECTED: [usize; 3] = [0, 4, 5];

/// Leave-one-out validation of the correction; see [`left_out`].
#[derive(Debug)]
pub struct LeftOut {
    /// The states of each ray, corrected by the other rays.
    pub states: Vec<Vec<ComparedState>>,
    /// Sums of the squared relative errors of W with its forces, of D and of D_peak, without and
    /// with the correction.
    errors: [[f64; 3]; 2],
}

impl LeftOut {
    /// Whether W, with the forces, D and D_peak are corrected.
    fn corrected(&self) -> [bool; 3] {
        let [before, after] = self.errors;
        std::array::from_fn(|i| after[i] < before[i])
    }

    /// The quantities that remain uncorrected, because the correction does not reduce their errors.
    pub fn uncorrected(&self) -> Vec<&'static str> {
        let corrected = self.corrected();
        let left = (0..3).filter(|&i| !corrected[i] && self.errors[0][i] > 0.0);
        left.map(|i| COMPARED[CORRECTED[i]]).collect()
    }
}

/// Leave-one-out validation: each ray, corrected by a bridge fitted to the other rays only. It
/// measures the error of the correction for rays that were not solved on both meshes. The choice of
/// the quantities that are corrected is made on all rays.
pub fn left_out(rays: &[ComparedRay]) -> Result<LeftOut, Fault> {
    let (found, needed) = (rays.len(), TERMS.len() + 1);
    if found < needed {
        // Too few to fit every term when one ray is left out.
        refuse!(
            "{found} rays are solved on the finer mesh too, but the correction needs at least \
             {needed}: increase `finer` in the campaign"
        );
    }
    let bridges: Vec<Bridge> =
        (0..rays.len()).map(|i| Bridge::fit(&[&rays[..i], &rays[i + 1..]].concat())).collect();
    let states = |corrected: [bool; 3]| -> Vec<Vec<ComparedState>> {
        let of_ray = |(ray, bridge): (&ComparedRay, &Bridge)| {
            let bridge = bridge.clone().only(corrected);
            let state = |(sample, reference): (&HingeSample, &HingeSample)| {
                ComparedState::new(&bridge.corrected(ray.ray, sample), reference)
            };
            ray.pairs().map(state).collect()
        };
        std::iter::zip(rays, &bridges).map(of_ray).collect()
    };
    let corrected = states([true; 3]);
    let checked =
        LeftOut { errors: [errors(&states([false; 3])), errors(&corrected)], states: corrected };
    Ok(LeftOut { states: states(checked.corrected()), ..checked })
}

/// The sums of the squared relative errors of W with its forces, of D and of D_peak; a quantity
/// that is 0 has none.
fn errors(states: &[Vec<ComparedState>]) -> [f64; 3] {
    let squares = |i: usize| {
        let known = states.iter().flatten().filter(|state| state.is_known(i));
        let (off, all) = known.fold((0.0, 0.0), |(off, all), state| {
            let difference = state.value[i] - state.reference[i];
            (off + difference.powi(2), all + state.reference[i].powi(2))
        });
        if all > 0.0 { off / all } else { 0.0 }
    };
    [(0..4).map(squares).sum(), squares(4), squares(5)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::{compare, relative_rms};
    use crate::rays::samples;
    use crate::rays::tests::{finer, rays};
    use crate::split::SplitPlan;
    use testkit::changed;

    const RAYS: usize = 40;

    /// Number of the rays that are solved on the finer mesh too, where most of them are.
    const TWICE: usize = RAYS - 1;

    fn database(rays: Vec<SolvedRay>) -> Database {
        Database::collect(rays, &SplitPlan::default()).unwrap()
    }

    /// Rays of one mesh and of a finer one in one database.
    fn on_both(coarse: Vec<SolvedRay>, fine: Vec<SolvedRay>) -> Database {
        database([coarse, finer(fine)].concat())
    }

    /// The rays on the coarser mesh.
    fn coarser(database: &Database) -> Vec<SolvedRay> {
        database.on_tier(Fidelity::default()).cloned().collect()
    }

    /// The [`rays`] with the errors of a coarse mesh, by a known q.
    fn coarse() -> Vec<SolvedRay> {
        let coarse = |x: &HingeSample, w_lig: f64| {
            let [eta_a, _] = x.deformation().eta(w_lig);
            let q = 0.03 + 0.02 * x.theta * x.theta - 0.5 * eta_a;
            let slopes = [-0.5 / w_lig, 0.0, 0.04 * x.theta];
            HingeSample {
                w: x.w * (1.0 + q),
                w_work: x.w * (1.0 + q),
                f_a: x.f_a * (1.0 + q) + x.w * slopes[0],
                f_s: x.f_s * (1.0 + q) + x.w * slopes[1],
                m_theta: x.m_theta * (1.0 + q) + x.w * slopes[2],
                d: 1.1 * x.d,
                d_peak: x.d_peak.map(|peak| 1.3 * peak),
                ..*x
            }
        };
        changed(rays(RAYS), |ray| {
            let w_lig = ray.design.w_lig;
            ray.samples.iter_mut().for_each(|sample| *sample = coarse(sample, w_lig));
        })
    }

    /// The coarse rays, most of them without the error of their mesh too.
    fn twice() -> Database {
        on_both(coarse(), rays(TWICE))
    }

    #[test]
    fn the_mesh_error_is_corrected_on_rays_that_were_solved_only_once() {
        let fine = database(rays(RAYS));
        let errors = |candidate: &Database| {
            let compared = compare(candidate, &fine);
            assert_eq!(compared.len(), RAYS);
            let states: Vec<_> = compared.iter().flat_map(ComparedRay::states).collect();
            relative_rms(&states, [0.0; 6])
        };
        let before = errors(&database(coarse()));
        let mut half = on_both(coarse(), rays(RAYS / 2));
        // A split that no plan gives.
        half.manifest.split.training.pop_first();
        let split = half.manifest().split.clone();
        let (corrected, _) = half.corrected().unwrap();
        // Ten seconds per ray; the seconds of the finer mesh are left out with its rows.
        let manifest = corrected.manifest();
        assert_eq!(manifest.cpu_s, 10.0 * RAYS as f64);
        assert_eq!((manifest.rays, manifest.rows), (RAYS, 10 * RAYS));
        assert_eq!(manifest.finer, None);
        assert_eq!(manifest.tier.to_string(), "default corrected to reference");
        assert_eq!(manifest.split, split);
        let after = errors(&corrected);
        // 1/(1 + q) is not a polynomial of degree two. The remaining error is largest in forces
        // that are small compared with W dq/da.
        for (before, after) in std::iter::zip(before, after) {
            assert!(after < before / 3.0, "{before} {after}");
        }
        assert!(after[0] < 1e-3 && after[3] < 3e-3, "{after:?}");
    }

    #[test]
    fn a_database_of_one_mesh_is_as_it_was() {
        let once = database(coarse());
        let (same, checked) = once.clone().corrected().unwrap();
        assert!(checked.is_none());
        assert_eq!(same.rays(), once.rays());
        assert_eq!(same.manifest(), once.manifest());
    }

    #[test]
    fn corrected_forces_are_the_gradient_of_the_corrected_energy() {
        let twice = twice();
        let bridge = Bridge::fit(&twice.on_both_meshes());
        let ray = &coarser(&twice)[0];
        let x = ray.samples[7];
        let moved = |[a, s, theta]: [f64; 3]| {
            // The solved energy, to first order about the sample.
            let w = x.w + x.f_a * a + x.f_s * s + x.m_theta * theta;
            let sample = HingeSample { a: x.a + a, s: x.s + s, theta: x.theta + theta, w, ..x };
            bridge.corrected(ray, &sample).w
        };
        let found = bridge.corrected(ray, &x);
        for (i, found) in [found.f_a, found.f_s, found.m_theta].into_iter().enumerate() {
            let step: [f64; 3] = std::array::from_fn(|j| if i == j { 1e-6 } else { 0.0 });
            let slope = (moved(step) - moved(step.map(|x| -x))) / 2e-6;
            assert!((found - slope).abs() < 1e-6 * slope.abs().max(1.0), "{found} {slope}");
        }
    }

    #[test]
    fn mirror_images_have_the_same_correction() {
        let twice = twice();
        let bridge = Bridge::fit(&twice.on_both_meshes());
        let rays = crate::rays::with_mirrored(&coarser(&twice)[1..2]);
        let [here, there] = [0, 1].map(|i| bridge.corrected(&rays[i], &rays[i].samples[3]));
        let there = there.mirrored();
        for (x, y) in [(there.w, here.w), (there.f_s, here.f_s), (there.d, here.d)] {
            assert!((x - y).abs() < 1e-12 * y.abs().max(1.0), "{x} {y}");
        }
    }

    #[test]
    fn a_left_out_ray_does_not_affect_its_own_correction() {
        let mut spoilt = rays(TWICE);
        spoilt[3].samples.iter_mut().for_each(|sample| sample.w *= 10.0);
        let twice = on_both(coarse(), spoilt);
        let rays = twice.on_both_meshes();
        let checked = left_out(&rays).unwrap().states;
        let i = rays.iter().position(|it| it.ray.job == "job-003").unwrap();
        let [corrected, solved] = [&checked[i], &rays[i].states()].map(|states| states[9].value[0]);
        assert!((corrected / solved - 1.0).abs() < 0.1, "{corrected} {solved}");
    }

    #[test]
    fn a_quantity_that_is_not_improved_remains_uncorrected() {
        // Damage differs by as much in either direction, ray by ray.
        let spoilt = changed(coarse(), |ray| {
            let odd = ray.job.ends_with(['1', '3', '5', '7', '9']);
            let factor = if odd { 1.3 } else { 0.7 };
            ray.samples.iter_mut().for_each(|sample| sample.d *= factor);
        });
        let twice = on_both(spoilt, rays(TWICE));
        let (corrected, checked) = twice.clone().corrected().unwrap();
        assert_eq!(checked.unwrap().uncorrected(), ["D"]);
        let coarse = coarser(&twice);
        assert_eq!(coarse.len(), corrected.rays().len());
        let both = || std::iter::zip(samples(&coarse), samples(corrected.rays()));
        assert!(both().all(|((_, before), (_, after))| before.d == after.d));
        assert!(both().any(|((_, before), (_, after))| before.w != after.w));

        let unknown = changed(twice.rays().to_vec(), |ray| {
            ray.samples.iter_mut().for_each(|sample| sample.d_peak = None);
        });
        let checked = left_out(&database(unknown).on_both_meshes()).unwrap();
        assert_eq!(checked.uncorrected(), ["D"]);
    }

    #[test]
    fn rays_solved_on_a_finer_tier_are_unchanged() {
        let mut retried = coarse();
        retried[0].solved_tier = mesher::Tier::Fine;
        let (corrected, _) = on_both(retried, rays(TWICE)).corrected().unwrap();
        let same = |i: usize| corrected.rays()[i].samples == coarse()[i].samples;
        assert!(same(0) && !same(1));
    }

    #[test]
    fn the_correction_is_constant_beyond_the_range_of_the_rays() {
        let twice = twice();
        let bridge = Bridge::fit(&twice.on_both_meshes());
        let at = |theta: f64| {
            let ray = &coarser(&twice)[0];
            let sample = HingeSample { theta, ..ray.samples[9] };
            let corrected = bridge.corrected(ray, &sample);
            [corrected.w / sample.w, corrected.m_theta / sample.m_theta]
        };
        let [energy, moment] = at(3.0);
        assert_eq!(energy, at(2.0)[0]);
        assert!((energy - moment).abs() < 1e-12, "{energy} {moment}");
    }

    #[test]
    fn too_few_rays_are_an_error() {
        let few = on_both(coarse(), rays(TERMS.len())).corrected();
        let few = few.unwrap_err().to_string();
        assert!(few.contains("13 rays") && few.contains("at least 14"), "{few}");
        assert!(on_both(coarse(), rays(14)).corrected().is_ok());
    }

    #[test]
    fn zero_reference_damage_gives_no_correction() {
        let gentle = changed(rays(TWICE), |ray| {
            ray.samples.iter_mut().for_each(|sample| sample.d = 0.0);
        });
        let twice = on_both(coarse(), gentle);
        let (corrected, _) = twice.corrected().unwrap();
        assert_eq!(corrected.rays()[0].samples[3].d, coarse()[0].samples[3].d);
    }
}
