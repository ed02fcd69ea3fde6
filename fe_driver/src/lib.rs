//! Window solves with CalculiX, one or a campaign of thousands.
//!
//! A *ray* drives one hinge design from the undeformed state straight to a deformation (a, s,
//! theta); every converged increment is a sample (W, grad W, D) of section 2.4. [`solve_window`]
//! solves one ray; a [`Campaign`] samples a box of designs and rays, [`plan`] says what is left to
//! do, [`run`] does it, [`finished_jobs`] hands out the samples, and [`restore`] takes them back.

mod campaign;
mod ccx;
mod dat;
mod deck;
mod doctor;
mod failure;
mod finished;
mod further_rays;
mod history;
mod job;
mod kept_solve;
mod ledger;
mod path;
mod plan;
mod ray;
mod response;
mod restore;
mod retry;
mod run;
mod sampling;
mod shard;
mod sta;
mod study;
mod window_solve;

pub use campaign::{Campaign, CampaignError};
pub use ccx::{CCX, Ccx, CcxRun};
pub use dat::{DatError, Frame, Layout, read_dat};
pub use deck::{StepControl, deck};
pub use doctor::{Diagnosis, doctor};
pub use failure::{FailureKind, Rung, UnknownFailure};
pub use finished::{FinishedJob, finished_jobs};
pub use further_rays::{Added, FurtherRaysError, add_further_rays};
pub use job::{FileError, JobSpec, ToolVersions};
pub use kept_solve::{KeptSolution, KeptSolve, KeptSolveError};
pub use ledger::{Status, Tally, Throughput, refuse_changed, status};
pub use path::{DeformationPath, PathError};
pub use plan::{Plan, plan};
pub use ray::Ray;
pub use restore::{Restored, restore};
pub use retry::retry;
pub use run::{Progress, RunOptions, run};
pub use sampling::RayBox;
pub use shard::{InvalidShard, Shard};
pub use sta::{Attempt, read_sta};
pub use study::{
    Richardson, STUDY_THETA_DEG, StudyCase, StudyState, richardson, study_cases, study_difference,
    study_state,
};
pub use window_solve::{
    SolveError, Tools, WindowModel, WindowProblem, WindowSolution, reached, solve_window,
};
