//! Rows of ten jobs, each with five increments.

use dataset::{Database, DatasetError, Fidelity, Row, SplitPlan};
use fe_driver::{FailureKind, ToolVersions};
use hinge::{HingeConstants, HingeSample};
use mesher::Tier;

pub fn row(job: usize, lambda: f64) -> Row {
    Row {
        job: format!("job-{job:02}"),
        design: HingeConstants::PAPER.hinge(5.0 + job as f64, 0.8 + 0.05 * job as f64),
        sample: HingeSample {
            lambda,
            a: 0.1 * lambda,
            s: -0.2 * lambda,
            theta: lambda,
            w: 50.0 * lambda * lambda + 1.0 / 3.0,
            m_theta: 100.0 * lambda,
            d: 0.01 * lambda,
            ..HingeSample::default()
        },
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

/// Five increments of each of ten jobs, unsorted.
pub fn rows() -> Vec<Row> {
    let lambdas = [0.6, 0.2, 1.0, 0.4, 0.8];
    let increments = |job| lambdas.map(|lambda| row(job, lambda));
    (0..10).rev().flat_map(increments).collect()
}

/// The first rays of [`rows`] on the mesh `reference`.
pub fn finer(rays: usize) -> Vec<Row> {
    on_tier(Tier::Reference, &rows()[5 * (10 - rays)..])
}

/// The rays on another mesh, each under another name.
pub fn on_tier(tier: Tier, rows: &[Row]) -> Vec<Row> {
    let solved = |row: &Row| Row {
        job: format!("{tier}-{}", row.job),
        settings_hash: format!("5e77-{tier}"),
        tier: Fidelity::Solved(tier),
        solved_tier: tier,
        cpu_s: 40.0,
        ..row.clone()
    };
    rows.iter().map(solved).collect()
}

pub fn collect(rows: Vec<Row>) -> Result<Database, DatasetError> {
    Database::collect(rows, &SplitPlan::default())
}
