//! Job folders written back from what was collected, so that nothing collected is solved again.

use crate::campaign::{Campaign, CampaignError};
use crate::finished::FinishedJob;
use crate::history::{Event, now};
use crate::job::JobRecord;
use crate::ledger::{CampaignFolder, Index};
use crate::shard::Shard;
use std::collections::HashMap;
use std::path::Path;

/// Writes the folders of jobs that `campaign` finished elsewhere or before, and returns how many.
///
/// Every job must be one of the campaign's: its id is a hash of all that decides the result. What
/// is closed in `folder` already is left as it is.
pub fn restore(
    campaign: &Campaign,
    folder: &Path,
    finished: &[FinishedJob],
) -> Result<usize, CampaignError> {
    let Some(first) = finished.first() else {
        return Ok(0);
    };
    let specs = campaign.jobs(&first.tools);
    let index = Index::of(&campaign.name, &specs);
    let specs: HashMap<_, _> = index.jobs.iter().zip(specs).collect();
    if let Some(stranger) = finished.iter().find(|job| !specs.contains_key(&job.id)) {
        return Err(CampaignError::Stranger(stranger.id.clone()));
    }
    let folder = CampaignFolder(folder.to_owned());
    let mut history = folder.enter(Shard::WHOLE, &index)?;
    let mut restored = 0;
    for job in finished {
        let home = folder.job(&job.id);
        if home.record()?.is_some_and(|record| record.is_closed()) {
            continue;
        }
        home.write_spec(&specs[&job.id])?;
        let rows_hash = home.write_samples(&job.samples)?;
        home.write_record(&record(job, rows_hash))?;
        history.note(&job.id, Event::Restored)?;
        restored += 1;
    }
    Ok(restored)
}

/// How a job stands that was solved elsewhere.
fn record(job: &FinishedJob, rows_hash: String) -> JobRecord {
    JobRecord {
        failure: job.failure,
        message: job.failure.map(|_| "restored from a database".to_owned()),
        next: None,
        attempts: 1,
        tier: job.solved_tier,
        rows: job.samples.len(),
        rows_hash,
        lambda: job.samples.last().map_or(0.0, |last| last.lambda),
        cpu_seconds: job.cpu_seconds,
        wall_seconds: job.cpu_seconds,
        ended: now(),
    }
}
