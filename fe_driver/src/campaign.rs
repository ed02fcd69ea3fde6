//! A campaign of window solves: definition, plan, run, ledger, results.

pub(crate) mod campaign_folder;
pub(crate) mod definition;
pub(crate) mod extra_rays;
pub(crate) mod run;
pub(crate) mod sampling;
pub(crate) mod spot_paths;
pub(crate) mod status;
