//! Job folders written back from what was collected, so that nothing collected is solved again.

use crate::campaign::{Campaign, CampaignError};
use crate::finished::FinishedJob;
use crate::history::{Event, now};
use crate::job::{JobRecord, ToolVersions};
use crate::ledger::{CampaignFolder, Index};
use crate::shard::Shard;
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// What became of the jobs that were to be restored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Restored {
    /// Written back.
    pub written: usize,
    /// Closed in the folder already, and left as they are.
    pub there: usize,
    /// None of the campaign's.
    pub strangers: usize,
}

/// Writes the folders of jobs back that `campaign` finished elsewhere or before.
///
/// The id of a job is a hash of all that decides the result: those of another campaign are left out, and
/// it is an error if all are.
pub fn restore(
    campaign: &Campaign,
    folder: &Path,
    finished: &[FinishedJob],
) -> Result<Restored, CampaignError> {
    let mut restored = Restored::default();
    let Some(first) = finished.first() else {
        return Ok(restored);
    };
    // Strangers may have been solved by other programs than the campaign's jobs.
    let mut tools: Vec<&ToolVersions> = Vec::new();
    for job in finished {
        if !tools.contains(&&job.tools) {
            tools.push(&job.tools);
        }
    }
    let jobs_with = |tools| {
        let specs = campaign.jobs(tools);
        let index = Index::of(&campaign.name, &specs);
        let ids: HashSet<&String> = index.jobs.iter().collect();
        let known = finished.iter().any(|job| ids.contains(&job.id));
        known.then_some((index, specs))
    };
    let Some((index, specs)) = tools.into_iter().find_map(jobs_with) else {
        return Err(CampaignError::Stranger(first.id.clone()));
    };
    let specs: HashMap<_, _> = index.jobs.iter().zip(specs).collect();
    let ours = || finished.iter().filter(|job| specs.contains_key(&job.id));
    restored.strangers = finished.len() - ours().count();
    let folder = CampaignFolder(folder.to_owned());
    let mut history = folder.enter(Shard::WHOLE, &index)?;
    for job in ours() {
        let home = folder.job(&job.id);
        if home.record()?.is_some_and(|record| record.is_closed()) {
            restored.there += 1;
            continue;
        }
        home.write_spec(&specs[&job.id])?;
        let rows_hash = home.write_samples(&job.samples)?;
        home.write_record(&record(job, rows_hash))?;
        history.note(&job.id, Event::Restored)?;
        restored.written += 1;
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
