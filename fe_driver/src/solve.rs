//! The service of solves of any kind: problem, solver, attempts, store, lists. The window solve is
//! one kind.

pub(crate) mod attempts;
pub(crate) mod deformation_path;
pub(crate) mod failure;
pub(crate) mod service;
pub(crate) mod solve_folder;
pub(crate) mod solved_ray;
pub(crate) mod solver;
#[cfg(test)]
pub(crate) mod tests;
pub(crate) mod window_solve;
