//! What a run would do, and why.

use crate::campaign::{Campaign, CampaignError};
use crate::job::{JobSpec, ToolVersions};
use crate::ledger::{CampaignFolder, Tally};
use std::collections::{BTreeMap, HashSet};
use std::path::Path;

/// What a run would do.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    pub tally: Tally,
    /// Jobs in the folder that the campaign no longer asks for, counted by what has changed.
    pub stale: BTreeMap<String, usize>,
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
    folder.belongs_to(campaign)?;
    let jobs = campaign.jobs(versions);
    let ids: HashSet<_> = jobs.iter().map(JobSpec::id).collect();
    let tally = folder.tally(&ids)?;
    let mut stale = BTreeMap::new();
    for id in folder.ids()?.iter().filter(|id| !ids.contains(*id)) {
        if let (Some(spec), Some(asked)) = (folder.job(id).spec()?, jobs.first()) {
            let changed = match asked.differences(&spec).as_slice() {
                [] => "rays".to_owned(),
                differences => differences.join(", "),
            };
            *stale.entry(changed).or_default() += 1;
        }
    }
    let seconds_a_job = match tally.closed() {
        0 => campaign.tier.usual_cpu_seconds(),
        closed => tally.wall_seconds / closed as f64,
    };
    Ok(Plan {
        seconds: seconds_a_job * tally.to_run() as f64,
        tally,
        stale,
    })
}
