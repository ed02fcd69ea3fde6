//! The finished solves of a campaign, from which the database is collected.

use crate::{CampaignError, CampaignFolder, Solved};
use std::path::Path;
use support::file_error::FileError;

/// The solves of the campaign in `folder` that are closed and have samples, in the order of their
/// ids, as in a database.
///
/// Stale jobs are omitted. Neither gmsh nor ccx needs to be installed.
pub fn finished_windows(
    folder: &Path,
) -> Result<impl Iterator<Item = Result<Solved, FileError>>, CampaignError> {
    let folder = CampaignFolder(folder.to_owned());
    let mut ids = folder.index()?.jobs;
    ids.sort_unstable();
    let store = folder.store();
    let windows = ids.into_iter().map(move |id| store.solve(&id).result());
    let has_samples = |window: &Solved| !window.samples.is_empty();
    Ok(windows.filter_map(move |window| window.map(|found| found.filter(has_samples)).transpose()))
}
