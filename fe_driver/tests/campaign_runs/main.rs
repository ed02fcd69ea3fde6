//! Campaigns with solvers that replay, fail or lie.

mod campaigns;
#[path = "../common/mod.rs"]
mod common;
mod fake_solvers;
mod replays;
