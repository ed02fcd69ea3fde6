//! Window solves with CalculiX: single solves, and campaigns of thousands of solves.
//!
//! A *ray* drives one hinge design along a straight line from the undeformed state to a deformation (a, s,
//! theta). Every converged increment is a sample (W, grad W, D) of section 2.4.
//!
//! Entry points: [`solve_window`] solves one ray. A [`Campaign`] defines the rays to solve; [`plan`] counts the
//! remaining jobs, [`run`] solves them, [`finished_jobs`] returns their samples, and [`restore`] recreates the job
//! folders from collected samples.
//!
//! One ray, with gmsh and CalculiX on the PATH:
//!
//! ```no_run
//! use fe_driver::{Ray, StepControl, Tools, WindowProblem, solve_window};
//! use hinge::{HingeConstants, HingeDeformation, SheetMaterial};
//! use mesher::Tier;
//! use std::path::Path;
//! use std::sync::atomic::AtomicBool;
//! use std::time::Duration;
//!
//! let problem = WindowProblem {
//!     ray: Ray {
//!         design: HingeConstants::PAPER.hinge(18.0, 90f64.to_radians()),
//!         end: HingeDeformation { a: 0.0, s: 0.0, theta: 60f64.to_radians() },
//!     },
//!     material: SheetMaterial::load(Path::new("configs/materials/pet-0.5mm.toml"))?,
//!     tier: Tier::Default,
//!     step: StepControl::default(),
//! };
//! let (limit, stop) = (Duration::from_secs(600), AtomicBool::new(false));
//! let solution = solve_window(&problem, &Tools::find()?, Path::new("runs/solve"), limit, &stop)?;
//! for sample in &solution.samples {
//!     println!("{:.3} rad: {:.1} N mm", sample.theta, sample.w);
//! }
//! # Ok::<_, Box<dyn std::error::Error>>(())
//! ```

#![warn(missing_docs)]

mod campaign;
mod doctor;
mod record_file;
mod window;

pub use campaign::array_script::{ArrayScript, SLURM, UnknownTemplateKey};
pub use campaign::definition::{Campaign, CampaignError};
pub use campaign::extra_rays::{Added, ExtraRaysError, add_extra_rays};
pub use campaign::finished::{FinishedJob, finished_jobs};
pub use campaign::job::JobSpec;
pub use campaign::ledger::{Status, Tally, Throughput, refuse_changed, status};
pub use campaign::plan::{Plan, plan, prepare};
pub use campaign::restore::{Restored, restore};
pub use campaign::retry::retry;
pub use campaign::run::{Progress, RunOptions, run};
pub use campaign::sampling::RayBox;
pub use campaign::slurm::{
    ArrayStates, SlurmError, Submission, array_states, slurm_folder, submit_array,
};
pub use campaign::solve_again::{Difference, SolvedAgain, solve_again};
pub use doctor::{Diagnosis, doctor};
pub use record_file::FileError;
pub use support::shard::Shard;
pub use window::ccx::{CCX, Ccx, CcxRun};
pub use window::convergence::{
    Richardson, STUDY_THETA_DEG, StudyCase, StudyState, richardson, study_cases, study_difference,
    study_state,
};
pub use window::dat::{DatError, Frame, Layout, read_dat};
pub use window::deck::deck;
pub use window::deformation_path::{DeformationPath, PathError};
pub use window::failure::{FailureKind, RetryStep, UnknownFailure};
pub use window::model::WindowModel;
pub use window::ray::Ray;
pub use window::solve::{SolveError, Tools, WindowProblem, WindowSolution, reached, solve_window};
pub use window::solve_cache::{KeptSolution, KeptSolve, KeptSolveError};
pub use window::sta::{Attempt, read_sta};
pub use window::step_control::StepControl;
pub use window::versions::ToolVersions;
