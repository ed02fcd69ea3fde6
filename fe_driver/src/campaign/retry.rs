//! Reopens failed jobs, for use after the cause of the failure has been removed.

use crate::campaign::definition::CampaignError;
use crate::campaign::history::Event;
use crate::campaign::job::JobState;
use crate::campaign::ledger::CampaignFolder;
use crate::window::failure::{FailureKind, RetryStep};
use std::path::Path;
use support::shard::Shard;

/// Reopens the closed jobs in `folder` that failed, or only those with one kind of failure, and returns their number.
///
/// The next run starts their retry ladder again. Existing samples are kept until an attempt reaches a larger lambda.
pub fn retry(folder: &Path, only: Option<FailureKind>) -> Result<usize, CampaignError> {
    let folder = CampaignFolder(folder.to_owned());
    let index = folder.index()?;
    let mut history = folder.enter(Shard::WHOLE, &index)?;
    let mut reopened = 0;
    for id in &index.jobs {
        let job = folder.job(id);
        let JobState::Ended(ended) = job.state()? else {
            continue;
        };
        let mut record = ended.1;
        if !record.is_closed() {
            continue;
        }
        if record
            .failure
            .is_some_and(|kind| only.is_none_or(|only| kind == only))
        {
            record.next = Some(RetryStep::AsAsked);
            job.write_record(&record)?;
            history.note(id, Event::Reopened)?;
            reopened += 1;
        }
    }
    Ok(reopened)
}
