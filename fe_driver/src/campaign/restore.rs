//! Recreates job folders from collected samples, so that collected jobs are not solved again.

use crate::campaign::definition::{Campaign, CampaignError};
use crate::campaign::finished::FinishedJob;
use crate::campaign::history::{Event, now};
use crate::campaign::job::{JobRecord, JobState};
use crate::campaign::ledger::{CampaignFolder, Index};
use crate::window::versions::ToolVersions;
use std::collections::{HashMap, HashSet};
use std::path::Path;
use support::shard::Shard;

/// Numbers of jobs that were restored, already present, and foreign.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Restored {
    /// Jobs that were restored.
    pub written: usize,
    /// Jobs that are already closed in the folder; they are not changed.
    pub there: usize,
    /// Jobs that do not belong to the campaign.
    pub strangers: usize,
}

/// Recreates the folders of jobs that `campaign` finished in another place or earlier.
///
/// The id of a job is a hash of all inputs of its result. Jobs of another campaign are omitted; it is an error if
/// all jobs are of another campaign.
pub fn restore(
    campaign: &Campaign,
    folder: &Path,
    finished: &[FinishedJob],
) -> Result<Restored, CampaignError> {
    let mut restored = Restored::default();
    let Some(first) = finished.first() else {
        return Ok(restored);
    };
    // Jobs of another campaign may have been solved with other versions of gmsh and ccx.
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
        if matches!(home.state()?, JobState::Ended(ended) if ended.1.is_closed()) {
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

/// The record of a job that was solved elsewhere.
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
        // The database does not contain the wall time.
        wall_seconds: 0.0,
        ended: now(),
    }
}
