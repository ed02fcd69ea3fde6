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
//! let tier = Tier::Default;
//! let problem = WindowProblem::new(ray.driven(tier.regime()), &film, tier);
//! let solve = WindowSolve::new(problem, &solver.versions());
//! let (limit, stop) = (Duration::from_secs(600), AtomicBool::new(false));
//! let solution = solver.attempt(&solve, Path::new("runs/solve"), limit, &stop)?;
//! for sample in &solution.samples {
//!     println!("{:.3} rad: {:.1} N mm", sample.theta, sample.w);
//! }
//! # Ok::<_, Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(test), warn(unreachable_pub))]

#[cfg(test)]
extern crate self as fe_driver;

mod calculix;
mod campaign;
mod record_file;
mod sheet;
mod solve;

pub(crate) use calculix::cards::{
    DrivenArc, PanelMotion, even_lambdas, real, rotated, write_amplitude, write_element,
    write_increments, write_material, write_motion, write_nodes, write_set,
};
pub(crate) use calculix::dat::{Block, Printed, at_node, numbers, read_printed};
pub(crate) use calculix::deck_run::{DeckRun, read_if_there, time_reached};
pub(crate) use calculix::response::{Damage, samples};
pub(crate) use campaign::campaign_folder::{CampaignFolder, EventLog, Index};
pub(crate) use campaign::extra_rays::read_extra_rays;
pub(crate) use record_file::{damaged, entries, read_json, short_hash, unless_damaged};
pub(crate) use sheet::sheet_deck::{SheetModel, force_set, hinge_set};
pub(crate) use sheet::sheet_nodes::{GRAVITY, STIFFNESS, SheetNodes};
pub(crate) use sheet::sheet_output::{SheetFrame, SheetLayout};
pub(crate) use sheet::sheet_problem::SECONDS;
pub(crate) use sheet::sheet_response::states;
pub(crate) use solve::attempts::{Job, SolveEvent, Workers, now};
pub(crate) use solve::solve_folder::{SolveState, host};

pub use calculix::calculix_solver::{CalculiX, reached};
pub use calculix::dat::{Increment, Layout, OutputFrame, read_dat, read_sta};
pub use calculix::deck::{WindowModel, deck};
pub use calculix::deck_run::{CCX, Ccx, CcxRun};
pub use campaign::campaign_folder::{Shard, finished_windows};
pub use campaign::definition::{Campaign, JobPart};
pub use campaign::run::{CampaignProgress, Restored, RunOptions, restore, run};
pub use campaign::sampling::RayBox;
pub use campaign::spot_paths::{DrawnStates, SpotPath, random_paths};
pub use campaign::status::{CampaignStatus, Plan, Tally, Throughput, known_parts, plan, status};
pub use sheet::sheet_problem::{
    HeldPanel, History, OutOfPlaneRestraint, Place, Pulled, SheetProblem, SheetSolve,
};
pub use sheet::sheet_solver::sheet_reached;
pub use sheet::sheet_states::{HingeState, PanelState, SheetState, SheetStates, SheetSurface};
pub use solve::attempts::SolveListError;
pub use solve::deformation_path::{DeformationPath, HingePath, Ray};
pub use solve::failure::{AttemptKind, Cause, FailureKind, SolveError};
pub use solve::service::SolveService;
pub use solve::solve_folder::{SolveFolder, SolveRecord, SolveStore};
pub use solve::solved_ray::{Fidelity, SolvedRay};
pub use solve::solver::{Solution, Solve, Solved, SolvedPath, Solver, ToolVersions};
pub use solve::window_solve::{StepControl, WindowProblem, WindowSolve};
pub use support::FileError;
