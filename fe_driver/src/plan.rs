//! What a run would do, and why.

use crate::campaign::{Campaign, CampaignError};
use crate::job::{JobRecord, JobSpec, ToolVersions};
use crate::ledger::{CampaignFolder, Index, Tally};
use serde::Serialize;
use std::collections::{BTreeMap, HashSet};
use std::path::Path;

/// What a run would do.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plan {
    pub tally: Tally,
    /// The jobs that a run would work on, counted by why.
    pub reasons: BTreeMap<String, usize>,
    /// Jobs in the folder that the campaign does not ask for any more; they are kept.
    pub stale: usize,
    /// Seconds that one worker would take.
    pub seconds: f64,
}

/// Says what [`crate::run`] would do in `folder`, and changes nothing.
pub fn plan(
    campaign: &Campaign,
    folder: &Path,
    versions: &ToolVersions,
) -> Result<Plan, CampaignError> {
    let folder = CampaignFolder(folder.to_owned());
    folder.belongs_to(&campaign.name)?;
    let specs = campaign.jobs(versions);
    let ids = Index::of(&campaign.name, &specs).jobs;
    let tally = folder.tally(&ids)?;
    let stale = stale(&folder, &ids)?;
    let mut reasons = BTreeMap::new();
    for (id, spec) in ids.iter().zip(&specs) {
        let job = folder.job(id);
        let reason = match job.record()? {
            Some(record) => retry_reason(&record),
            None if job.spec()?.is_some() => Some("interrupted".to_owned()),
            None => Some(new_reason(spec, &stale)),
        };
        if let Some(reason) = reason {
            *reasons.entry(reason).or_default() += 1;
        }
    }
    let seconds_a_job = match tally.closed() {
        0 => campaign.tier.usual_cpu_seconds(),
        closed => tally.wall_seconds / closed as f64,
    };
    Ok(Plan {
        seconds: seconds_a_job * tally.to_run() as f64,
        tally,
        reasons,
        stale: stale.len(),
    })
}

/// What was asked of the jobs in the folder that are none of these.
fn stale(folder: &CampaignFolder, ids: &[String]) -> Result<Vec<JobSpec>, CampaignError> {
    let asked: HashSet<_> = ids.iter().collect();
    let others = folder.ids()?.into_iter().filter(|id| !asked.contains(id));
    let specs = others.map(|id| folder.job(&id).spec());
    Ok(specs
        .filter_map(Result::transpose)
        .collect::<Result<_, _>>()?)
}

/// Why a job that has ended an attempt is tried again, if it is.
fn retry_reason(record: &JobRecord) -> Option<String> {
    let (failure, next) = (record.failure?, record.next?);
    Some(format!("{failure}, next {}", next.name()))
}

/// Why a job is to be solved for the first time: its ray may have been, under other settings.
fn new_reason(spec: &JobSpec, stale: &[JobSpec]) -> String {
    let same_ray = |old: &&JobSpec| old.problem.ray == spec.problem.ray;
    match stale.iter().find(same_ray) {
        Some(old) => format!("stale: {} changed", spec.differences(old).join(", ")),
        None => "new".to_owned(),
    }
}
