//! Solves by finite elements: the service that makes them, and campaigns of thousands of window
//! solves.
//!
//! **Solve.** A [`Solve`] is a problem with everything that determines its result, driven along a
//! path of increments from lambda = 0 to 1. What is kept of the converged increments is a
//! [`SolvedPath`]. A further kind of problem is one more implementation of the two traits.
//!
//! **Window.** A [`WindowSolve`] drives one hinge design along one path, from the undeformed state
//! to a deformation (a, s, theta). Every converged increment is a sample (W, grad W, D) of section
//! 2.4. A *ray* is a straight path. Where no kind is named, a type that works for any kind of solve
//! is the type for windows.
//!
//! **Identity.** The id of a solve is a hash of the problem: for a window, of hinge, path,
//! material, tier and mesh, increments, versions of the programs and of this crate.
//!
//! **Solver.** A [`Solver`] makes one attempt at a solve of its kind. [`CalculiX`] is one, the
//! deterministic `FakeSolver` of the tests another; a further program is one more implementation.
//!
//! **Attempts.** A solve whose problem its solver refuses is attempted otherwise, depending on the
//! [`FailureKind`] and as its kind of problem says ([`Solve::next_attempt`]): a window with shorter
//! increments, then on a finer mesh ([`AttemptKind`]). The samples of the attempt that reaches
//! furthest are kept. What the machine does to an attempt ([`Cause`]) decides nothing of a result:
//! the same attempt is made again, and after a few times the solve stays open.
//!
//! **Store.** Every solve has one folder in a [`SolveStore`], named by its id, whose files appear
//! whole or not at all. A solve without its result is not done. What is done is not solved again.
//! Folders of several kinds of problem can be in one store.
//!
//! **List.** [`SolveService::solve`] works through a list of solves of one kind on parallel workers
//! and promises: every result, in order, or an error (a missing program, a full disk, a stop, a
//! solve that the machine ends again and again), after which the same list continues where it
//! ended. A solve that fails ends no list: it is a [`Solved`] that names its failure and its
//! folder.
//!
//! **Campaign.** A [`Campaign`] is a list of window solves with a ledger: [`plan`] counts what is
//! left, [`run`] solves it, [`finished_windows`] returns the results, and [`restore`] recreates the
//! store from collected samples.
//!
//! One ray, with gmsh and CalculiX on the PATH:
//!
//! ```no_run
//! use fe_driver::{CalculiX, Ray, Solver, WindowProblem, WindowSolve};
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
//! let solve = WindowSolve::new(WindowProblem::new(ray.driven(Tier::Default.regime()), &film, Tier::Default), &solver.versions());
//! let (limit, stop) = (Duration::from_secs(600), AtomicBool::new(false));
//! let solution = solver.attempt(&solve, Path::new("runs/solve"), limit, &stop)?;
//! for sample in &solution.samples {
//!     println!("{:.3} rad: {:.1} N mm", sample.theta, sample.w);
//! }
//! # Ok::<_, Box<dyn std::error::Error>>(())
//! ```

#[cfg(test)]
extern crate self as fe_driver;

mod calculix;
mod campaign;
mod record_file;
mod sheet;
mod solve;

pub use calculix::calculix_solver::{CalculiX, reached};
pub use calculix::ccx::{CCX, Ccx, CcxRun};
pub use calculix::dat::{DatError, Frame, Layout, read_dat};
pub use calculix::deck::deck;
pub use calculix::model::WindowModel;
pub use calculix::sta::{Increment, read_sta};
pub use campaign::array_script::{ArrayScript, SLURM, ScriptError};
pub use campaign::definition::{Campaign, CampaignError, JobPart};
pub use campaign::extra_rays::ExtraRaysError;
pub use campaign::finished_windows::finished_windows;
pub use campaign::plan::{Plan, plan, prepare};
pub use campaign::restore::{CollectedWindow, Restored, restore};
pub use campaign::run::{Progress, RunOptions, run};
pub use campaign::sampling::RayBox;
pub use campaign::slurm::{
    ArrayStates, JobId, SlurmError, Submission, array_states, slurm_folder, submit_array,
};
pub use campaign::spot_paths::{DrawnStates, SpotPath, random_paths};
pub use campaign::status::{Status, Tally, Throughput, known_parts, status};
pub use sheet::invalid_sheet_problem::InvalidSheetProblem;
pub use sheet::sheet_problem::{
    DrivenRim, Held, History, Keeping, Place, Pulled, SheetProblem, SheetSolve,
};
pub use sheet::sheet_solver::sheet_reached;
pub use sheet::sheet_states::{HingeState, PanelState, SheetState, SheetStates, SheetSurface};
pub use solve::attempts::SolveListError;
pub use solve::deformation_path::{DeformationPath, PathError};
pub use solve::failure::{Cause, FailureKind, UnknownFailure};
pub use solve::hinge_path::{HingePath, Ray};
pub use solve::ladder::AttemptKind;
pub use solve::problem::{Solve, SolvedPath};
pub use solve::service::SolveService;
pub use solve::solve_error::SolveError;
pub use solve::solve_folder::{SolveFolder, SolveRecord, SolveStore};
pub use solve::solved::{Solved, Unsolved};
pub use solve::solver::{Solution, Solver};
pub use solve::step_control::StepControl;
pub use solve::tool_versions::ToolVersions;
pub use solve::window_solve::{WindowProblem, WindowSolve};
pub use support::file_error::FileError;
pub use support::shard::Shard;
