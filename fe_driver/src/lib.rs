//! Window solves by finite elements: the service that makes them, and campaigns of thousands of them.
//!
//! **Solve.** A [`WindowSolve`] drives one hinge design along one path, from the undeformed state to a deformation
//! (a, s, theta). Every converged increment is a sample (W, grad W, D) of section 2.4. A *ray* is a straight path.
//!
//! **Identity.** Hinge, path, material, tier and mesh, increments, versions of the programs and of this crate determine the
//! result. The id of a solve is a hash of them.
//!
//! **Solver.** A [`WindowSolver`] makes one attempt at a solve. [`CalculiX`] is one, the deterministic [`FakeSolver`] of the
//! tests another; a further program is one more implementation.
//!
//! **Attempts.** A solve that fails is attempted again, at most three times ([`AttemptKind`]) and depending on the
//! [`FailureKind`]: the same again, shorter increments, a finer mesh. The samples of the attempt that reaches furthest are kept.
//!
//! **Store.** Every solve has one folder in a [`SolveStore`], named by its id, whose files appear whole or not at all. A
//! solve without its result is not done. What is done is not solved again.
//!
//! **List.** [`WindowService::solve`] works through a list of solves on parallel workers and promises: every result, in
//! order, or an error that halts the whole list (a missing program, a full disk, a stop), after which the same list
//! continues where it ended. A window that fails ends no list: it is a [`SolvedWindow`] that names its failure and its
//! folder.
//!
//! **Campaign.** A [`Campaign`] is a list of solves with a ledger: [`plan`] counts what is left, [`run`] solves it,
//! [`finished_windows`] returns the results, and [`restore`] recreates the store from collected samples.
//!
//! One ray, with gmsh and CalculiX on the PATH:
//!
//! ```no_run
//! use fe_driver::{CalculiX, Ray, WindowProblem, WindowSolve, WindowSolver};
//! use hinge::{HingeConstants, HingeDeformation, SheetMaterial};
//! use mesher::Tier;
//! use std::path::Path;
//! use std::sync::atomic::AtomicBool;
//! use std::time::Duration;
//!
//! let ray = Ray {
//!     design: HingeConstants::PAPER.hinge(18.0, 90f64.to_radians()),
//!     end: HingeDeformation { a: 0.0, s: 0.0, theta: 60f64.to_radians() },
//! };
//! let film = SheetMaterial::load(Path::new("configs/materials/pet-0.5mm.toml"))?;
//! let solver = CalculiX::find()?;
//! let solve = WindowSolve::new(WindowProblem::new(ray, &film, Tier::Default), &solver.versions());
//! let (limit, stop) = (Duration::from_secs(600), AtomicBool::new(false));
//! let solution = solver.attempt(&solve, Path::new("runs/solve"), limit, &stop)?;
//! for sample in &solution.samples {
//!     println!("{:.3} rad: {:.1} N mm", sample.theta, sample.w);
//! }
//! # Ok::<_, Box<dyn std::error::Error>>(())
//! ```

#![warn(missing_docs)]

mod calculix;
mod campaign;
mod record_file;
mod solve;

pub use calculix::calculix_solver::{CalculiX, reached};
pub use calculix::ccx::{CCX, Ccx, CcxRun};
pub use calculix::dat::{DatError, Frame, Layout, read_dat};
pub use calculix::deck::deck;
pub use calculix::model::WindowModel;
pub use calculix::sta::{Increment, read_sta};
pub use campaign::array_script::{ArrayScript, SLURM, UnknownTemplateKey};
pub use campaign::definition::{Campaign, CampaignError};
pub use campaign::extra_rays::{Added, ExtraRaysError, add_extra_rays};
pub use campaign::finished_windows::finished_windows;
pub use campaign::plan::{Plan, plan, prepare};
pub use campaign::restore::{CollectedWindow, Restored, restore};
pub use campaign::retry::retry;
pub use campaign::run::{Progress, RunOptions, run};
pub use campaign::sampling::RayBox;
pub use campaign::slurm::{
    ArrayStates, SlurmError, Submission, array_states, slurm_folder, submit_array,
};
pub use campaign::solve_again::{Difference, SolvedAgain, solve_again};
pub use campaign::status::{Status, Tally, Throughput, refuse_changed, status};
pub use solve::attempts::SolveListError;
pub use solve::deformation_path::{DeformationPath, PathError};
pub use solve::failure::{FailureKind, UnknownFailure};
pub use solve::fake_solver::{FakeSolver, Fault};
pub use solve::hinge_path::{HingePath, Ray};
pub use solve::ladder::AttemptKind;
pub use solve::service::WindowService;
pub use solve::solve_folder::{SolveFolder, SolveRecord, SolveStore};
pub use solve::solved_window::{SolvedWindow, UnsolvedWindow};
pub use solve::step_control::StepControl;
pub use solve::tool_versions::ToolVersions;
pub use solve::window_solve::{WindowProblem, WindowSolve};
pub use solve::window_solver::{SolveError, WindowSolution, WindowSolver};
pub use support::file_error::FileError;
pub use support::shard::Shard;
