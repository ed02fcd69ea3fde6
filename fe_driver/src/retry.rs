//! Giving closed jobs another chance, after what made them fail has changed.

use crate::campaign::CampaignError;
use crate::failure::{FailureKind, Rung};
use crate::history::Event;
use crate::ledger::CampaignFolder;
use crate::shard::Shard;
use std::path::Path;

/// Reopens the closed jobs in `folder` that failed, or only those of one kind, and returns how many.
///
/// The next run climbs their retry ladder anew; samples they have are kept until an attempt
/// reaches further.
pub fn retry(folder: &Path, only: Option<FailureKind>) -> Result<usize, CampaignError> {
    let folder = CampaignFolder(folder.to_owned());
    let index = folder.index()?;
    let mut history = folder.enter(Shard::WHOLE, &index)?;
    let mut reopened = 0;
    for id in &index.jobs {
        let job = folder.job(id);
        let Some(mut record) = job.record()?.filter(|record| record.is_closed()) else {
            continue;
        };
        if record
            .failure
            .is_some_and(|kind| only.is_none_or(|only| kind == only))
        {
            record.next = Some(Rung::AsAsked);
            job.write_record(&record)?;
            history.note(id, Event::Reopened)?;
            reopened += 1;
        }
    }
    Ok(reopened)
}
