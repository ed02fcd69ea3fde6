//! Solved windows as rows of a database, and back.

use crate::verification_error::VerificationError;
use dataset::{Database, Fidelity, Row, SplitPlan};
use fe_driver::{CollectedWindow, Solved, finished_windows};
use hinge::HingeSample;
use std::path::Path;

/// Rows with these samples of a solved window.
pub fn rows(
    window: &Solved,
    samples: impl IntoIterator<Item = HingeSample>,
) -> impl Iterator<Item = Row> {
    let (solve, record) = (&window.solve, &window.record);
    let problem = &solve.problem;
    let row = Row {
        job: window.id.clone(),
        design: problem.hinge.design,
        sample: HingeSample::default(),
        failure: record.failure,
        material: problem.material.name.clone(),
        material_hash: problem.material.law_hash(),
        settings_hash: solve.settings_hash(),
        tier: Fidelity::Solved(problem.tier),
        solved_tier: record.tier,
        tools: solve.tools.clone(),
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

/// The solves that the rows come from; `rows` must be sorted by job and lambda.
pub fn collected_windows(rows: &[Row]) -> Vec<CollectedWindow> {
    let window = |rows: &[Row]| {
        let row = rows[0].clone();
        CollectedWindow {
            id: row.job,
            tools: row.tools,
            solved_tier: row.solved_tier,
            samples: rows.iter().map(|row| row.sample).collect(),
            cpu_seconds: row.cpu_s,
            failure: row.failure,
        }
    };
    rows.chunk_by(|a, b| a.job == b.job).map(window).collect()
}
