//! Ten rays, each with five increments.

use dataset::{Database, Fidelity, SolvedRay, SplitPlan};
use fe_driver::{FailureKind, ToolVersions};
use hinge::{HingeConstants, HingeSample};
use mesher::Tier;
use support::Fault;
use testkit::changed;

pub fn sample(lambda: f64) -> HingeSample {
    HingeSample {
        lambda,
        a: 0.1 * lambda,
        s: -0.2 * lambda,
        theta: lambda,
        w: 50.0 * lambda * lambda + 1.0 / 3.0,
        m_theta: 100.0 * lambda,
        d: 0.01 * lambda,
        ..HingeSample::default()
    }
}

pub fn ray(job: usize) -> SolvedRay {
    SolvedRay {
        job: format!("job-{job:02}"),
        design: HingeConstants::PAPER.hinge(5.0 + job as f64, 0.8 + 0.05 * job as f64),
        samples: [0.6, 0.2, 1.0, 0.4, 0.8].map(sample).to_vec(),
        failure: (job == 2).then_some(FailureKind::Diverged),
        material: "film".into(),
        material_hash: "f11f".into(),
        settings_hash: "5e77".into(),
        tier: Fidelity::default(),
        solved_tier: if job == 3 { Tier::Fine } else { Tier::Default },
        tools: ToolVersions { gmsh: "4.8.4".into(), ccx: "2.20".into() },
        cpu_s: 9.5,
    }
}

/// Five increments of each of ten rays, unsorted.
pub fn rays() -> Vec<SolvedRay> {
    (0..10).rev().map(ray).collect()
}

/// The first rays on the mesh `reference`.
pub fn finer(count: usize) -> Vec<SolvedRay> {
    on_tier(Tier::Reference, rays().split_off(10 - count))
}

/// The rays on another mesh, each under another name.
pub fn on_tier(tier: Tier, rays: Vec<SolvedRay>) -> Vec<SolvedRay> {
    changed(rays, |ray| {
        ray.job = format!("{tier}-{}", ray.job);
        ray.settings_hash = format!("5e77-{tier}");
        ray.tier = Fidelity::Solved(tier);
        ray.solved_tier = tier;
        ray.cpu_s = 40.0;
    })
}

pub fn collect(rays: Vec<SolvedRay>) -> Result<Database, Fault> {
    Database::collect(rays, &SplitPlan::default())
}
