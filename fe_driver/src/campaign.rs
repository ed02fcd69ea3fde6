//! A campaign of window solves: definition, plan, run, job records, retries, results.

pub(crate) mod array_script;
pub(crate) mod definition;
pub(crate) mod extra_rays;
pub(crate) mod finished;
pub(crate) mod history;
pub(crate) mod host;
pub(crate) mod job;
mod job_folders;
pub(crate) mod ledger;
pub(crate) mod plan;
pub(crate) mod restore;
pub(crate) mod retry;
pub(crate) mod run;
pub(crate) mod sampling;
mod shard_history;
pub(crate) mod slurm;
pub(crate) mod solve_again;
