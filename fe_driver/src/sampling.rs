//! Which rays a campaign solves: a seeded Latin hypercube, block by block.
//!
//! Rays come in blocks of 40, each a Latin hypercube of its own over (log w_lig, alpha, and the
//! end of the ray), 5 of them pure rotations. So any prefix is a usable database, and a larger
//! campaign of the same seed begins with the smaller one.
//!
//! A hinge that is pulled or sheared before it turns is stretched in its plane: it stores up to ten
//! times the energy of any deployed one, and is where solvers stop early. Hinges of a deployed sheet
//! turn as they translate, or are compressed. So tension and shear reach their full range only from
//! `full_range_deg` of rotation on, less in proportion below, and together stay inside an ellipse.
//! Compression, which buckles, always has its full range; and a compressed ligament may be sheared
//! as long as it stays slack, its ends no further apart than they were:
//!
//! (1 + eta_a)^2 + eta_s^2 <= 1.

use crate::ray::Ray;
use hinge::{HingeConstants, HingeDeformation};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

/// Rays in a block.
const BLOCK: usize = 40;
/// One ray in this many is a pure rotation.
const ROTATION_EVERY: usize = 8;
/// Coordinates of the hypercube: log w_lig, alpha, theta, eta_a, eta_s.
const DIMENSIONS: usize = 5;

/// The box of designs and ray ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RayBox {
    /// Least and greatest ligament width (mm), sampled evenly in its logarithm.
    pub w_lig: [f64; 2],
    /// Least and greatest cut angle; at most 90, as mirroring gives the rest.
    pub alpha_deg: [f64; 2],
    /// Greatest compression (negative) and tension at the end of a ray, over w_lig.
    pub eta_a: [f64; 2],
    /// Greatest shear at the end of a ray, over w_lig, of either sign.
    pub eta_s: f64,
    /// Least and greatest rotation at the end of a ray; pure rotations go to the greatest.
    pub theta_deg: [f64; 2],
    /// Rotation from which on tension and shear have their full range.
    pub full_range_deg: f64,
}

impl RayBox {
    /// The first `count` rays of the campaign with this seed.
    pub fn rays(&self, common: &HingeConstants, count: usize, seed: u64) -> Vec<Ray> {
        (0..count.div_ceil(BLOCK) as u64)
            .flat_map(|block| {
                let mut random = ChaCha8Rng::seed_from_u64(seed);
                random.set_stream(block);
                latin_hypercube(&mut random)
            })
            .take(count)
            .enumerate()
            .map(|(i, point)| self.ray(common, point, i % ROTATION_EVERY == 0))
            .collect()
    }

    /// The ray at a point of the unit cube.
    fn ray(&self, common: &HingeConstants, point: [f64; DIMENSIONS], pure_rotation: bool) -> Ray {
        let [log_w, alpha, theta, eta_a, eta_s] = point;
        let between = |[from, to]: [f64; 2], share: f64| from + (to - from) * share;
        let w_lig = between(self.w_lig.map(f64::ln), log_w).exp();
        let end = if pure_rotation {
            HingeDeformation::from_eta(0.0, 0.0, self.theta_deg[1].to_radians(), w_lig)
        } else {
            let theta = between(self.theta_deg, theta);
            let range = (theta / self.full_range_deg).min(1.0);
            let [compression, tension] = [self.eta_a[0], self.eta_a[1] * range];
            let eta_a = between([compression, tension], eta_a);
            let pull = if eta_a > 0.0 { eta_a / tension } else { 0.0 };
            let stretched = self.eta_s * range * (1.0 - pull * pull).sqrt();
            let slack = (1.0 - (1.0 + eta_a).powi(2)).max(0.0).sqrt();
            let shear = stretched.max(slack).min(self.eta_s);
            let eta_s = between([-shear, shear], eta_s);
            HingeDeformation::from_eta(eta_a, eta_s, theta.to_radians(), w_lig)
        };
        Ray {
            design: common.hinge(w_lig, between(self.alpha_deg, alpha).to_radians()),
            end,
        }
    }

    /// The inequality that the box violates, if any.
    pub(crate) fn defect(&self) -> Option<String> {
        let rules = [
            (
                0.0 < self.w_lig[0] && self.w_lig[0] <= self.w_lig[1],
                "0 < w_lig[0] <= w_lig[1]",
            ),
            (
                0.0 < self.alpha_deg[0]
                    && self.alpha_deg[0] <= self.alpha_deg[1]
                    && self.alpha_deg[1] <= 90.0,
                "0 < alpha_deg[0] <= alpha_deg[1] <= 90 (mirroring gives the rest)",
            ),
            (
                -1.0 < self.eta_a[0] && self.eta_a[0] <= 0.0 && 0.0 <= self.eta_a[1],
                "-1 < eta_a[0] <= 0 <= eta_a[1]",
            ),
            (self.eta_a[1] < 1.0, "eta_a[1] < 1"),
            ((0.0..1.0).contains(&self.eta_s), "0 <= eta_s < 1"),
            (
                0.0 <= self.theta_deg[0]
                    && self.theta_deg[0] <= self.theta_deg[1]
                    && self.theta_deg[1] > 0.0
                    && self.theta_deg[1] <= 120.0,
                "0 <= theta_deg[0] <= theta_deg[1] <= 120, theta_deg[1] > 0",
            ),
            (
                (1.0..=180.0).contains(&self.full_range_deg),
                "1 <= full_range_deg <= 180 (degrees, not radians)",
            ),
        ];
        rules
            .iter()
            .find(|(holds, _)| !holds)
            .map(|(_, rule)| format!("[rays] violates {rule}"))
    }
}

/// One block of points in the unit cube; each coordinate meets every 1/BLOCK once.
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
        w_lig: [5.0, 25.0],
        alpha_deg: [45.0, 90.0],
        eta_a: [-0.8, 0.25],
        eta_s: 0.4,
        theta_deg: [5.0, 75.0],
        full_range_deg: 30.0,
    };
    const COMMON: HingeConstants = HingeConstants {
        fillet_ratio: 0.16,
        kerf: 0.2,
        r_win: 100.0,
    };

    #[test]
    fn a_block_is_a_latin_hypercube() {
        let points = latin_hypercube(&mut ChaCha8Rng::seed_from_u64(3));
        for dimension in 0..DIMENSIONS {
            let mut strata: Vec<_> = points
                .iter()
                .map(|point| (point[dimension] * BLOCK as f64) as usize)
                .collect();
            strata.sort_unstable();
            assert!(strata.into_iter().eq(0..BLOCK));
        }
    }

    #[test]
    fn a_larger_campaign_begins_with_the_smaller() {
        let rays = BOX.rays(&COMMON, 200, 1);
        assert_eq!(BOX.rays(&COMMON, 70, 1), rays[..70]);
        assert_ne!(BOX.rays(&COMMON, 70, 2), rays[..70]);
        assert_ne!(rays[..40], rays[40..80]);
    }

    #[test]
    fn rays_stay_in_the_box_and_stretch_little_before_they_turn() {
        for (i, ray) in BOX.rays(&COMMON, 400, 1).iter().enumerate() {
            ray.design.validate().unwrap();
            let [eta_a, eta_s] = ray.end.eta(ray.design.w_lig);
            let theta = ray.end.theta.to_degrees();
            let range = (theta / 30.0).min(1.0);
            let [pull, shear] = [eta_a.max(0.0) / (0.25 * range), eta_s / (0.4 * range)];
            let slack = (1.0 + eta_a).hypot(eta_s) <= 1.0 + 1e-12;
            assert!(slack || pull.hypot(shear) <= 1.0 + 1e-12);
            assert!(eta_a >= -0.8 && eta_s.abs() <= 0.4);
            assert_eq!(i % 8 == 0, eta_a == 0.0 && eta_s == 0.0 && theta > 74.9);
        }
    }

    /// Where hinges of deployed sheets live, every octant of states has its rays: small rotations
    /// with large shear among them, if compressed.
    #[test]
    fn every_prefix_covers_where_deployed_hinges_live() {
        let rays = BOX.rays(&COMMON, 80, 1);
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
        let early = |([_, eta_s], theta): &&([f64; 2], f64)| *theta < 30.0 && eta_s.abs() > 0.25;
        assert!(ends.iter().filter(early).count() >= 4);
    }

    #[test]
    fn violated_inequalities_are_named() {
        assert_eq!(BOX.defect(), None);
        let radians = RayBox {
            full_range_deg: 0.5,
            ..BOX
        };
        assert!(radians.defect().unwrap().contains("not radians"));
        let wide = RayBox {
            alpha_deg: [45.0, 120.0],
            ..BOX
        };
        assert!(wide.defect().unwrap().contains("mirroring"));
        let nan = RayBox {
            eta_s: f64::NAN,
            ..BOX
        };
        assert!(nan.defect().unwrap().contains("eta_s"));
    }
}
