//! Conversion between the jobs of a campaign and the rows of a database.

use anyhow::{Context, Result};
use dataset::Row;
use fe_driver::{FinishedJob, ToolVersions};

/// The rows of one job.
pub fn rows_of(job: &FinishedJob) -> impl Iterator<Item = Row> {
    job.samples.iter().map(|sample| Row {
        job: job.id.clone(),
        design: job.design,
        sample: *sample,
        failure: job.failure.map_or(String::new(), |kind| kind.to_string()),
        material: job.material.clone(),
        material_hash: job.material_hash.clone(),
        settings_hash: job.settings_hash.clone(),
        tier: job.tier.to_string(),
        solved_tier: job.solved_tier.to_string(),
        gmsh: job.tools.gmsh.clone(),
        ccx: job.tools.ccx.clone(),
        cpu_s: job.cpu_seconds,
    })
}

/// The jobs that the rows come from; `rows` must be sorted by job and lambda.
pub fn jobs_of(rows: &[Row]) -> Result<Vec<FinishedJob>> {
    rows.chunk_by(|a, b| a.job == b.job)
        .map(|rows| job_of(rows).with_context(|| format!("job {}", rows[0].job)))
        .collect()
}

/// The job that the rows come from; `rows` must not be empty.
fn job_of(rows: &[Row]) -> Result<FinishedJob> {
    let row = &rows[0];
    let failure = match row.failure.as_str() {
        "" => None,
        name => Some(name.parse()?),
    };
    Ok(FinishedJob {
        id: row.job.clone(),
        design: row.design,
        material: row.material.clone(),
        material_hash: row.material_hash.clone(),
        settings_hash: row.settings_hash.clone(),
        tier: row.tier.parse()?,
        solved_tier: row.solved_tier.parse()?,
        tools: ToolVersions {
            gmsh: row.gmsh.clone(),
            ccx: row.ccx.clone(),
        },
        samples: rows.iter().map(|row| row.sample).collect(),
        cpu_seconds: row.cpu_s,
        failure,
    })
}
