//! The service that solves windows: identity, solver, attempts, store, lists.

pub(crate) mod attempts;
pub(crate) mod deformation_path;
pub(crate) mod failure;
pub(crate) mod fake_solver;
pub(crate) mod hinge_path;
pub(crate) mod host;
pub(crate) mod ladder;
pub(crate) mod service;
pub(crate) mod solve_folder;
pub(crate) mod solved_window;
pub(crate) mod step_control;
pub(crate) mod tool_versions;
pub(crate) mod window_solve;
pub(crate) mod window_solver;
