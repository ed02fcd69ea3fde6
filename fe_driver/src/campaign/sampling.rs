//! Sampling of the rays of a campaign: a seeded Latin hypercube, block by block.
//!
//! Rays are sampled in blocks of 40. Each block is a separate Latin hypercube over (log w_lig,
//! alpha, and the end of the ray), and 5 of its rays are pure rotations. Therefore any prefix is a
//! usable database, and a larger campaign with the same seed begins with the smaller one.
//!
//! The ends of the rays fill one region of (eta_a, eta_s, theta) at every ligament width.
//! Compression and rotation always have their full range, because the ligament relieves them by
//! buckling. Tension and shear stretch a ligament in its plane and store energy in proportion to
//! w_lig^2, whereas a rotation stores energy in proportion to w_lig. Tension and shear stay inside
//! a half-ellipse that grows with the rotation,
//!
//! ```text
//! (eta_a / (A rho))^2 + (eta_s / S)^2 / rho <= 1      for eta_a >= 0,
//! rho = rho_0 + (1 - rho_0) min(1, theta / theta_full),   rho_0 = min(1, w_full / w_lig),
//! ```
//!
//! with A and S the maximum tension and shear. A compressed ligament may additionally be sheared as
//! long as it is slack, that is, while the distance of its ends is at most the original one: (1 +
//! eta_a)^2 + eta_s^2 <= 1. A ligament of a plate turns freely about its middle: eta_a is measured
//! from its axial opening there, 0.5 theta + 0.16 theta^2. For the paper's film and w_full = 8 mm
//! no ray end stores more than about 500 N mm, five times the energy of a deployed hinge.

use crate::Ray;
use hinge::{HingeConstants, HingeDeformation, NetLigament, Regime};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Number of rays in a block.
const BLOCK: usize = 40;
/// Every ray whose index is a multiple of this number is a pure rotation.
const ROTATION_EVERY: usize = 8;
/// Fraction of the other rays that end in tension; compared to compression, its range is narrower
/// and its forces are larger.
const TENSION_FRACTION: f64 = 0.4;
/// Maximum number of rays; a larger number is a typing error.
const MAX_COUNT: usize = 1_000_000;
/// Coordinates of the hypercube: log w_lig, alpha, theta, eta_a, eta_s, fillet_ratio.
const DIMENSIONS: usize = 6;

/// A region of designs and ray ends, and how many rays are drawn in it.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RayBox {
    /// Number of rays, 1 to 1 000 000.
    pub count: usize,
    /// Seed of the rays; more rays with the same seed begin with the fewer ones.
    pub seed: u64,
    /// Number of the rays, its first ones, that are solved on `finer_tier` too. `train` corrects
    /// the others by them.
    #[serde(default)]
    pub finer: usize,
    /// Minimum and maximum ligament width (mm), 0.5 to 500, sampled uniformly in its logarithm.
    pub w_lig: [f64; 2],
    /// Minimum and maximum cut angle (deg), above 0 and at most 90, because mirroring gives the
    /// rest.
    pub alpha_deg: [f64; 2],
    /// Minimum and maximum radius of the hole, over w_lig. Rays end where the hinge with the hole
    /// of `[design]` and the same net ligament would.
    pub fillet_ratio: [f64; 2],
    /// Maximum compression (negative) and maximum tension at the end of a ray, over w_lig; above -1
    /// and below 1. For a plate they are measured from the free turn of its ligament, 0.5 theta +
    /// 0.16 theta^2 (rad), at which pure rotations end.
    pub eta_a: [f64; 2],
    /// Maximum shear of either sign at the end of a ray, over w_lig; at least 0 and below 1.
    pub eta_s: f64,
    /// Minimum and maximum rotation at the end of a ray (deg), -30 to 120; negative closes the cut.
    /// Pure rotations end at the maximum.
    pub theta_deg: [f64; 2],
    /// Median rotation at the end of the rays (deg), inside `theta_deg`, pure rotations excluded.
    pub median_deg: f64,
    /// Rotation above which tension and shear have their full range at any width (deg), 1 to 180.
    pub full_range_deg: f64,
    /// Ligament width up to which tension and shear have their full range at any rotation (mm), at
    /// least 0.
    pub full_range_w_lig: f64,
}

impl RayBox {
    /// The first `count` rays of hinges with the constants `common`, in films or in plates.
    pub fn rays(&self, common: &HingeConstants, regime: Regime, count: usize) -> Vec<Ray> {
        let free = regime.free_opening();
        (0..count.div_ceil(BLOCK) as u64)
            .flat_map(|block| {
                let mut random = ChaCha8Rng::seed_from_u64(self.seed);
                random.set_stream(block);
                latin_hypercube(&mut random)
            })
            .take(count)
            .enumerate()
            .map(|(i, point)| self.ray(common, free, point, i % ROTATION_EVERY == 0))
            .collect()
    }

    /// The ray at a point of the unit cube.
    fn ray(
        &self,
        common: &HingeConstants,
        [first, second]: [f64; 2],
        point: [f64; DIMENSIONS],
        pure_rotation: bool,
    ) -> Ray {
        let [log_w, alpha, theta, eta_a, eta_s, hole] = point;
        let between = |[from, to]: [f64; 2], fraction: f64| from + (to - from) * fraction;
        let mut design = common.hinge(
            between(self.w_lig.map(f64::ln), log_w).exp(),
            between(self.alpha_deg, alpha).to_radians(),
        );
        design.fillet_ratio = between(self.fillet_ratio, hole);
        let ligament = NetLigament::new(&design, common.fillet_ratio);
        let w_lig = ligament.design(&design).w_lig;
        let [eta_a, eta_s, theta_deg] = if pure_rotation {
            [0.0, 0.0, self.theta_deg[1]]
        } else {
            let theta = self.theta_at(theta);
            let range = self.range(w_lig, theta);
            let tension = self.eta_a[1] * range;
            let eta_a = match eta_a / TENSION_FRACTION {
                fraction @ ..1.0 => tension * (1.0 - fraction),
                _ => self.eta_a[0] * (eta_a - TENSION_FRACTION) / (1.0 - TENSION_FRACTION),
            };
            let pull = if eta_a > 0.0 { eta_a / tension } else { 0.0 };
            let stretched = self.eta_s * (range * (1.0 - pull * pull)).sqrt();
            let slack = (1.0 - (1.0 + eta_a).powi(2)).max(0.0).sqrt();
            let shear = stretched.max(slack).min(self.eta_s);
            let eta_s = between([-shear, shear], eta_s);
            [eta_a, eta_s, theta]
        };
        let theta = theta_deg.to_radians();
        let eta_a = theta * (first + second * theta.abs()) + eta_a;
        let end = HingeDeformation::from_eta(eta_a, eta_s, theta, w_lig);
        Ray { design, end: ligament.actual(&end) }
    }

    /// The quantile of the rotation (degrees): this fraction of the rays ends below it.
    fn theta_at(&self, fraction: f64) -> f64 {
        let [minimum, maximum] = self.theta_deg;
        let median = self.median_deg;
        match 2.0 * fraction {
            lower @ ..1.0 => minimum + (median - minimum) * lower,
            upper => median + (maximum - median) * (upper - 1.0),
        }
    }

    /// rho: the fraction of the range of tension and shear at a width (mm) and a rotation
    /// (degrees).
    fn range(&self, w_lig: f64, theta: f64) -> f64 {
        let flat = (self.full_range_w_lig / w_lig).min(1.0);
        (flat + (1.0 - flat) * theta / self.full_range_deg).clamp(0.0, 1.0)
    }

    /// The first inequality that the box violates; `None` if it is valid.
    pub(crate) fn defect(&self) -> Option<String> {
        let Self { w_lig, alpha_deg, fillet_ratio, eta_a, eta_s, .. } = *self;
        let [minimum, maximum] = self.theta_deg;
        let theta = [-30.0, minimum, self.median_deg, maximum, 120.0];
        let rules = [
            ((1..=MAX_COUNT).contains(&self.count), "1 <= count <= 1000000"),
            (self.finer <= self.count, "finer <= count"),
            (0.0 < w_lig[0] && w_lig.is_sorted(), "0 < w_lig[0] <= w_lig[1]"),
            (
                0.0 < alpha_deg[0] && alpha_deg.is_sorted() && alpha_deg[1] <= 90.0,
                "0 < alpha_deg[0] <= alpha_deg[1] <= 90 (mirroring gives the rest)",
            ),
            (
                0.0 < fillet_ratio[0] && fillet_ratio.is_sorted() && fillet_ratio[1] < 1.0,
                "0 < fillet_ratio[0] <= fillet_ratio[1] < 1",
            ),
            (alpha_deg[1] >= 5.0, "alpha_deg[1] >= 5: angles are in degrees, not radians"),
            (maximum >= 2.5, "theta_deg[1] >= 2.5: rotations are in degrees, not radians"),
            (
                -1.0 < eta_a[0] && [eta_a[0], 0.0, eta_a[1]].is_sorted(),
                "-1 < eta_a[0] <= 0 <= eta_a[1]",
            ),
            (eta_a[1] < 1.0, "eta_a[1] < 1"),
            ((0.0..1.0).contains(&eta_s), "0 <= eta_s < 1"),
            (
                theta.is_sorted() && maximum > 0.0,
                "-30 <= theta_deg[0] <= median_deg <= theta_deg[1] <= 120, theta_deg[1] > 0",
            ),
            (
                (0.0..f64::INFINITY).contains(&self.full_range_w_lig),
                "0 <= full_range_w_lig < infinity (mm)",
            ),
            (
                (1.0..=180.0).contains(&self.full_range_deg),
                "1 <= full_range_deg <= 180 (degrees, not radians)",
            ),
        ];
        rules.iter().find(|(holds, _)| !holds).map(|(_, rule)| format!("[[rays]] violates {rule}"))
    }
}

/// One block of points in the unit cube; each coordinate has exactly one value in each interval of
/// length 1/BLOCK.
fn latin_hypercube(random: &mut ChaCha8Rng) -> Vec<[f64; DIMENSIONS]> {
    let mut points = vec![[0.0; DIMENSIONS]; BLOCK];
    for dimension in 0..DIMENSIONS {
        let mut strata: Vec<_> = (0..BLOCK).collect();
        strata.shuffle(random);
        for (point, stratum) in points.iter_mut().zip(strata) {
            point[dimension] = (stratum as f64 + random.random::<f64>()) / BLOCK as f64;
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: RayBox = RayBox {
        count: 80,
        seed: 1,
        finer: 0,
        w_lig: [5.0, 25.0],
        alpha_deg: [45.0, 90.0],
        fillet_ratio: [0.16, 0.16],
        eta_a: [-0.8, 0.25],
        eta_s: 0.4,
        theta_deg: [-5.0, 75.0],
        median_deg: 25.0,
        full_range_deg: 50.0,
        full_range_w_lig: 8.0,
    };
    const COMMON: HingeConstants = HingeConstants::PAPER;

    #[test]
    fn a_block_is_a_latin_hypercube() {
        let points = latin_hypercube(&mut ChaCha8Rng::seed_from_u64(3));
        for dimension in 0..DIMENSIONS {
            let mut strata: Vec<_> =
                points.iter().map(|point| (point[dimension] * BLOCK as f64) as usize).collect();
            strata.sort_unstable();
            assert!(strata.into_iter().eq(0..BLOCK));
        }
    }

    #[test]
    fn a_larger_campaign_begins_with_the_smaller() {
        let rays = BOX.rays(&COMMON, Regime::Film, 200);
        assert_eq!(BOX.rays(&COMMON, Regime::Film, 70), rays[..70]);
        let other = RayBox { seed: 2, ..BOX };
        assert_ne!(other.rays(&COMMON, Regime::Film, 70), rays[..70]);
        assert_ne!(rays[..40], rays[40..80]);
    }

    #[test]
    fn rays_stay_in_their_region_and_stretch_wide_ligaments_little_at_small_rotations() {
        let rays = BOX.rays(&COMMON, Regime::Film, 400);
        for (i, ray) in rays.iter().enumerate() {
            ray.design.validate().unwrap();
            let w_lig = ray.design.w_lig;
            let [eta_a, eta_s] = ray.end.eta(w_lig);
            let theta = ray.end.theta.to_degrees();
            let flat = (8.0 / w_lig).min(1.0);
            let range = flat + (1.0 - flat) * (theta / 50.0).min(1.0);
            let [pull, shear] = [eta_a.max(0.0) / (0.25 * range), eta_s / 0.4];
            let slack = (1.0 + eta_a).hypot(eta_s) <= 1.0 + 1e-12;
            assert!(slack || pull * pull + shear * shear / range <= 1.0 + 1e-12);
            assert!(eta_a >= -0.8 && eta_s.abs() <= 0.4 && theta > -5.0);
            assert_eq!(i % 8 == 0, eta_a == 0.0 && eta_s == 0.0 && theta > 74.9);
        }
        let fraction = |is: &dyn Fn([f64; 2], f64) -> bool| {
            let met = rays.iter().filter(|ray| is(ray.end.eta(ray.design.w_lig), ray.end.theta));
            met.count() as f64 / rays.len() as f64
        };
        // 7/8 of the rays are not pure rotations: 1/2 of these end below 25 deg, 4/10 in tension.
        // One in twelve of the rays below 25 deg closes the cut.
        assert!((fraction(&|_, theta| theta < 25f64.to_radians()) - 0.44).abs() < 0.03);
        assert!((fraction(&|[eta_a, _], _| eta_a > 0.0) - 0.35).abs() < 0.03);
        assert!((fraction(&|_, theta| theta < 0.0) - 0.07).abs() < 0.03);
    }

    /// Rays of a plate end around the axial opening of a ligament that turns freely.
    #[test]
    fn rays_of_a_plate_are_measured_from_the_free_opening() {
        let [plate, film] =
            [Regime::Plate, Regime::Film].map(|regime| BOX.rays(&COMMON, regime, 80));
        let pairs = std::iter::zip(plate, film);
        for (plate, film) in pairs {
            assert_eq!((plate.design, plate.end.theta), (film.design, film.end.theta));
            let theta = plate.end.theta;
            let free = 0.5 * theta + 0.16 * theta * theta.abs();
            let [plate, film] = [plate, film].map(|ray| ray.end.eta(ray.design.w_lig));
            assert!((plate[0] - film[0] - free).abs() < 1e-12);
            assert_eq!(plate[1], film[1]);
        }
    }

    /// Sampling the hole changes no other coordinate of a ray, in the measures of the hinge with
    /// the same net ligament.
    #[test]
    fn the_hole_is_sampled_over_its_range() {
        let range = [0.03, 0.4];
        let sampled = RayBox { fillet_ratio: range, ..BOX };
        let rays = sampled.rays(&COMMON, Regime::Film, 80);
        for (ray, plain) in std::iter::zip(&rays, BOX.rays(&COMMON, Regime::Film, 80)) {
            assert_eq!(ray.design.w_lig, plain.design.w_lig);
            assert_eq!(ray.design.alpha, plain.design.alpha);
            assert_eq!(ray.end.theta, plain.end.theta);
            let ligament = NetLigament::new(&ray.design, COMMON.fillet_ratio);
            let [eta_a, eta_s] =
                ligament.deformation(&ray.end).eta(ligament.design(&ray.design).w_lig);
            assert!(eta_a > -0.81 && eta_a < 0.26 && eta_s.abs() < 0.41);
            ray.design.validate().unwrap();
        }
        let holes = || rays.iter().map(|ray| ray.design.fillet_ratio);
        assert!(holes().all(|hole| (range[0]..=range[1]).contains(&hole)));
        assert!(holes().any(|hole| hole < 0.04) && holes().any(|hole| hole > 0.39));
        let turned = RayBox { fillet_ratio: [0.4, 0.03], ..BOX };
        assert!(turned.defect().unwrap().contains("fillet_ratio[0] <="));
    }

    /// Every octant of the states of deployed hinges contains rays, including compressed states
    /// with small rotation and large shear.
    #[test]
    fn every_prefix_covers_the_states_of_deployed_hinges() {
        let rays = BOX.rays(&COMMON, Regime::Film, 80);
        let ends: Vec<_> = rays
            .iter()
            .map(|ray| (ray.end.eta(ray.design.w_lig), ray.end.theta.to_degrees()))
            .collect();
        for compressed in [true, false] {
            for sheared in [-1.0, 1.0] {
                for turned in [true, false] {
                    let octant = ends.iter().filter(|([eta_a, eta_s], theta)| {
                        (*eta_a < -0.3) == compressed
                            && eta_s * sheared > 0.05
                            && (*theta > 35.0) == turned
                    });
                    assert!(octant.count() >= 2, "{compressed} {sheared} {turned}");
                }
            }
        }
        let early = |([_, eta_s], theta): &&([f64; 2], f64)| *theta < 20.0 && eta_s.abs() > 0.2;
        assert!(ends.iter().filter(early).count() >= 4);
    }

    #[test]
    fn violated_inequalities_are_named() {
        assert_eq!(BOX.defect(), None);
        let radians = RayBox { full_range_deg: 0.5, ..BOX };
        assert!(radians.defect().unwrap().contains("not radians"));
        let wide = RayBox { alpha_deg: [45.0, 120.0], ..BOX };
        assert!(wide.defect().unwrap().contains("mirroring"));
        let nan = RayBox { eta_s: f64::NAN, ..BOX };
        assert!(nan.defect().unwrap().contains("eta_s"));
    }
}
