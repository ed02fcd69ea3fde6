//! Reopens failed jobs, for use after the cause of the failure has been removed.

use crate::campaign::campaign_folder::CampaignFolder;
use crate::campaign::definition::CampaignError;
use crate::campaign::history::Event;
use crate::solve::failure::FailureKind;
use crate::solve::window_solve::WindowSolve;
use std::path::Path;
use support::shard::Shard;

/// Reopens the closed jobs in `folder` that failed, or only those with one kind of failure, and
/// returns their number.
///
/// The next run starts their ladder of attempts again. Existing samples are kept until an attempt
/// reaches a larger lambda.
pub fn retry(folder: &Path, only: Option<FailureKind>) -> Result<usize, CampaignError> {
    let folder = CampaignFolder(folder.to_owned());
    let (index, store) = (folder.index()?, folder.store());
    let mut history = folder.enter(Shard::WHOLE, &index)?;
    let mut reopened = 0;
    for id in &index.jobs {
        let is_meant = |kind| only.is_none_or(|only| kind == only);
        if store.solve(id).reopen::<WindowSolve>(is_meant)? {
            history.note(id, Event::Reopened)?;
            reopened += 1;
        }
    }
    Ok(reopened)
}
