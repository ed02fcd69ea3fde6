//! Designs and weights are checked by finite elements: lists of window solves, and what follows
//! from them.
//!
//! | task | entry point |
//! |---|---|
//! | the database of a campaign | [`collected`] |
//! | a sheet in equilibrium with the forces of finite elements | [`balanced`], [`SheetErrors`] |
//! | a design searched for with finite elements for its hinges | [`final_design`] |
//! | the whole sheet, its panels rigid or meshed | [`SheetTask`], [`SheetCheck`] |
//! | errors of weights at random states | [`spot_check`], [`SpotStates`] |
//! | the hinges of designed sheets along their paths | [`visited_paths`] |
//! | rays of a campaign solved in rounds until weights are accurate | [`Learning`] |
//!
//! Windows are solved by a [`SolveService`](fe_driver::SolveService). One that fails ends no task:
//! it is named in the result, which states what it leaves unknown. The example checks weights at
//! eight states:
//!
//! ```no_run
//! use fe_driver::{CalculiX, DrawnStates, SolveService, SolveStore, random_paths};
//! use hinge::SheetMaterial;
//! use mesher::Tier;
//! use std::path::Path;
//! use std::sync::atomic::AtomicBool;
//! use std::time::Duration;
//! use surrogate::Surrogate;
//! use verification::spot_check;
//!
//! # let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
//! # let folder = tempfile::tempdir()?;
//! let weights = Surrogate::load(&repository.join("data/pet-0.5mm/small.safetensors"))?;
//! let film = SheetMaterial::load(&repository.join("configs/materials/pet-0.5mm.toml"))?;
//! let windows = SolveService {
//!     solver: Box::new(CalculiX::find()?),
//!     store: SolveStore(folder.path().to_owned()),
//!     workers: 2,
//!     limit: Duration::from_secs(60),
//!     stop: &AtomicBool::new(false),
//!     progress: Box::new(|done, all| println!("{done} of {all}")),
//! };
//! let inside = DrawnStates { domain: weights.domain(), constants: &weights.card().hinge, regime: Tier::Tiny.regime() };
//! let paths = random_paths(inside, 8, 4, 0);
//! let check = spot_check(&windows, &paths, &film, Tier::Tiny)?;
//! assert_eq!((check.rays.len(), check.unsolved.len()), (2, 0));
//! # Ok::<_, Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(test), warn(unreachable_pub))]

mod balanced_sheet;
mod element_windows;
mod final_design;
mod finished_panel;
mod learning;
mod sheet_check;
mod sheet_errors;
mod sheet_page;
mod sheet_task;
mod solved_rays;
mod verification_error;
mod visited;
mod whole_sheet;

pub use balanced_sheet::{
    BALANCED, BALANCED_FORCES, BalanceEnd, Balanced, Round, balanced, movements, size,
};
pub use element_windows::{ElementWindows, UnsolvedHinge, verification_tier};
pub use final_design::{final_design, most_cpu_seconds};
pub use learning::{Accuracy, Learning, LearningEnd, LearningRound, LearningTask};
pub use sheet_check::{HingeCheck, PanelCheck, SheetCheck, StateCheck};
pub use sheet_errors::SheetErrors;
pub use sheet_task::SheetTask;
pub use solved_rays::{
    SCALE, SpotStates, collected, distillation_states, spot_check, spread_table,
};
pub use verification_error::{VerificationError, every_ray_failed};
pub use visited::visited_paths;
pub use whole_sheet::{SheetCost, usual_sheet_tier};
