//! Solved windows as rows of a database, and back. A database is a table of text and numbers; this
//! is the only place where kinds of failure, tiers and versions are written to it and read from it.

use crate::verification_error::VerificationError;
use dataset::{Database, Row, SplitPlan};
use fe_driver::{CollectedWindow, FailureKind, Solved, ToolVersions, finished_windows};
use hinge::HingeSample;
use mesher::Tier;
use std::path::Path;
use support::fault::Fault;

/// Rows with these samples of a solved window.
pub fn rows(
    window: &Solved,
    samples: impl IntoIterator<Item = HingeSample>,
) -> impl Iterator<Item = Row> {
    let (solve, record) = (&window.solve, &window.record);
    let (problem, tools) = (&solve.problem, &solve.tools);
    let row = Row {
        job: window.id.clone(),
        design: problem.hinge.design,
        sample: HingeSample::default(),
        failure: (record.failure).map_or(String::new(), |kind| kind.to_string()),
        material: problem.material.name.clone(),
        material_hash: problem.material.law_hash(),
        settings_hash: solve.settings_hash(),
        tier: problem.tier.to_string(),
        solved_tier: record.tier.to_string(),
        gmsh: tools.gmsh.clone(),
        ccx: tools.ccx.clone(),
        cpu_s: record.cpu_seconds,
    };
    let of_sample = move |sample| Row { sample, ..row.clone() };
    samples.into_iter().map(of_sample)
}

/// The database of the finished rays of the campaign that was last run in a folder.
pub fn collected(folder: &Path) -> Result<Database, VerificationError> {
    let mut all = Vec::new();
    for window in finished_windows(folder)? {
        let window = window.map_err(fe_driver::CampaignError::from)?;
        all.extend(rows(&window, window.samples.iter().copied()));
    }
    Ok(Database::collect(all, &SplitPlan::default())?)
}

/// A row that is not of a solved window.
#[derive(Debug, thiserror::Error)]
#[error("job {job}: {reason}")]
pub struct InvalidRow {
    job: String,
    reason: Fault,
}

/// The solves that the rows come from; `rows` must be sorted by job and lambda.
pub fn collected_windows(rows: &[Row]) -> Result<Vec<CollectedWindow>, InvalidRow> {
    let window = |rows: &[Row]| {
        let job = rows[0].job.clone();
        collected_window(rows).map_err(|reason| InvalidRow { job, reason })
    };
    rows.chunk_by(|a, b| a.job == b.job).map(window).collect()
}

/// The solve that the rows come from; `rows` must not be empty.
fn collected_window(rows: &[Row]) -> Result<CollectedWindow, Fault> {
    let row = &rows[0];
    let failure: Option<FailureKind> = match row.failure.as_str() {
        "" => None,
        name => Some(name.parse()?),
    };
    let solved_tier: Tier = row.solved_tier.parse()?;
    Ok(CollectedWindow {
        id: row.job.clone(),
        tools: ToolVersions { gmsh: row.gmsh.clone(), ccx: row.ccx.clone() },
        solved_tier,
        samples: rows.iter().map(|row| row.sample).collect(),
        cpu_seconds: row.cpu_s,
        failure,
    })
}
