//! Finite elements judge designs and weights: lists of window solves, and what follows from them.
//!
//! | task | entry point |
//! |---|---|
//! | rows of a database from solved windows, and back | [`rows`], [`collected`], [`collected_windows`] |
//! | the hinges of a sheet solved along their paths, against a surrogate | [`recorded_paths`], [`replay`] |
//! | a sheet in equilibrium with the forces of finite elements | [`balanced`] |
//! | a design searched on with these forces | [`polish`] |
//! | errors of weights at random states | [`random_paths`], [`spot_check`] |
//! | rays where the training data is thin | [`rays_on_paths`], [`doubtful_states`], [`rays_through`] |
//! | rays of a campaign solved in rounds until weights are accurate | [`learn`] |
//!
//! Windows are solved by a [`WindowService`](fe_driver::WindowService). One that fails ends no task: it is named in the
//! result, which says what it leaves unknown.

#![warn(missing_docs)]

mod balanced_sheet;
mod doubtful_states;
mod error;
mod extension;
mod learning;
mod networks;
mod polish;
mod recorded_path;
mod region;
mod replay;
mod rows;
mod spot_check;

pub use balanced_sheet::{
    BALANCED, BalanceEnd, Balanced, ElementWindows, Round, balanced, movements, size,
};
pub use doubtful_states::{DoubtfulState, doubtful_states, rays_through};
pub use error::VerificationError;
pub use extension::{PathRays, rays_on_paths};
pub use learning::{Accuracy, LearningEnd, LearningRound, LearningSteps, LearningTask, learn};
pub use networks::{ensemble, judging_tier};
pub use polish::{PolishGain, PolishTask, Polished, polish};
pub use recorded_path::{RecordedPath, paths_of, recorded_paths};
pub use region::{distillation_states, region};
pub use replay::{ReplayedHinge, UnsolvedHinge, replay};
pub use rows::{InvalidRow, collected, collected_windows, rows};
pub use spot_check::{SpotCheck, SpotPath, random_paths, spot_check};
