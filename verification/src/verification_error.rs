//! Errors of this crate.

use design::objective::design_problem::DesignError;
use fe_driver::SolveListError;
use std::path::Path;
use support::{Fault, FileError, fault};

/// Why a task has no result.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum VerificationError {
    #[error(transparent)]
    Solve(#[from] SolveListError),
    #[error(transparent)]
    Design(#[from] DesignError),
    #[error("cannot use {0}")]
    File(#[from] FileError),
    #[error("finite elements solved no hinge: {0}. Try another mesh with --tier")]
    NoHinge(String),
    #[error(transparent)]
    Fault(#[from] Fault),
}

/// The error of a campaign in a folder none of whose rays has rows.
pub fn every_ray_failed(folder: &Path) -> Fault {
    fault!(
        "every ray failed: read a job's log in {}, fix the cause, then run `kirigami campaign run --retry`",
        folder.join("jobs").display()
    )
}
