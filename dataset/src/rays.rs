//! The rays of a database: their samples, their mirror images, and when two are the same.

use fe_driver::SolvedRay;
use hinge::HingeSample;

/// The samples of rays, each with its ray.
pub fn samples(rays: &[SolvedRay]) -> impl Iterator<Item = (&SolvedRay, &HingeSample)> + Clone {
    rays.iter().flat_map(|ray| ray.samples.iter().map(move |sample| (ray, sample)))
}

/// The rays followed by their mirror images.
///
/// ```text
/// W(a, s, theta; alpha) = W(a, -s, theta; pi - alpha),   and the same for D
/// ```
///
/// Mirror only after the split: an image contains no information beyond the information in its
/// original.
pub fn with_mirrored(rays: &[SolvedRay]) -> Vec<SolvedRay> {
    let images = rays.iter().map(|ray| SolvedRay {
        design: ray.design.mirrored(),
        samples: ray.samples.iter().map(HingeSample::mirrored).collect(),
        ..ray.clone()
    });
    rays.iter().cloned().chain(images).collect()
}

/// Design and end of a ray, in millionths of their units.
pub(crate) type RayKey = [i64; 8];

/// Design and end of a ray, or where it would end straight on; `None` without samples. It may bend.
pub(crate) fn ray_key(ray: &SolvedRay) -> Option<RayKey> {
    let (design, x) = (&ray.design, ray.samples.last()?);
    let [a, s, theta] = [x.a, x.s, x.theta].map(|component| component / x.lambda);
    let ray =
        [design.w_lig, design.alpha, design.fillet_ratio, design.kerf, design.r_win, a, s, theta];
    Some(ray.map(|number| (1e6 * number).round() as i64))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use fe_driver::{FailureKind, Fidelity, ToolVersions};
    use hinge::HingeConstants;
    use mesher::Tier;
    use std::f64::consts::PI;
    use testkit::changed;

    #[test]
    fn an_image_has_the_same_energy_and_the_opposite_shear_force() {
        let rays = rays(3);
        let both = with_mirrored(&rays);
        assert_eq!(both.len(), 2 * rays.len());
        assert_eq!(both[..rays.len()], rays);
        let pairs = std::iter::zip(samples(&rays), samples(&both[rays.len()..]));
        for ((ray, original), (image, sample)) in pairs {
            assert_eq!(image.design.alpha, PI - ray.design.alpha);
            assert_eq!(image.design.w_lig, ray.design.w_lig);
            assert_eq!(
                [sample.a, sample.s, sample.theta],
                [original.a, -original.s, original.theta]
            );
            assert_eq!(
                [sample.w, sample.d, sample.f_a, sample.m_theta],
                [original.w, original.d, original.f_a, original.m_theta]
            );
            assert_eq!(sample.f_s, -original.f_s);
        }
    }

    /// The ray `index` of the quadratic energy 10 (a^2 + s^2) + 50 theta^2, with ten increments.
    pub fn ray(index: usize) -> SolvedRay {
        let x = index as f64;
        let end = [0.3 * (1.7 * x).sin(), 0.2 * (2.9 * x).cos(), 1.0];
        let sample = |lambda: f64| {
            let [a, s, theta] = end.map(|v| v * lambda);
            HingeSample {
                lambda,
                a,
                s,
                theta,
                w: 10.0 * (a * a + s * s) + 50.0 * theta * theta,
                w_work: 10.0 * (a * a + s * s) + 50.0 * theta * theta,
                w_elastic: 5.0 * lambda * lambda,
                f_a: 20.0 * a,
                f_s: 20.0 * s,
                m_theta: 100.0 * theta,
                plastic_integral: lambda,
                d: 0.01 * lambda,
                d_peak: Some(0.1 * lambda),
                uz_max: 20.0 * lambda.sqrt(),
                energy_residual: 1e-3,
            }
        };
        SolvedRay {
            job: format!("job-{index:03}"),
            design: HingeConstants::PAPER
                .hinge(15.0 + 8.0 * (0.9 * x).sin(), 1.1 + 0.4 * (1.3 * x).sin()),
            samples: (1..=10).map(|k| sample(0.1 * f64::from(k))).collect(),
            failure: (index == 1).then_some(FailureKind::Diverged),
            material: "film".into(),
            material_hash: "f11f".into(),
            settings_hash: "5e77".into(),
            tier: Fidelity::default(),
            solved_tier: Tier::Default,
            tools: ToolVersions { gmsh: "4.8.4".into(), ccx: "2.20".into() },
            cpu_s: 10.0,
        }
    }

    /// The first rays.
    pub fn rays(count: usize) -> Vec<SolvedRay> {
        (0..count).map(ray).collect()
    }

    /// The same rays on a finer mesh.
    pub fn finer(rays: Vec<SolvedRay>) -> Vec<SolvedRay> {
        changed(rays, |ray| {
            ray.job = format!("fine-{}", ray.job);
            ray.settings_hash = "f19e".into();
            ray.tier = Fidelity::Solved(Tier::Reference);
            ray.solved_tier = Tier::Reference;
        })
    }
}
