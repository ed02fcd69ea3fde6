//! One window solve: input deck, CalculiX process, readers of its output, samples.

pub(crate) mod ccx;
pub(crate) mod convergence;
pub(crate) mod dat;
pub(crate) mod deck;
pub(crate) mod deformation_path;
pub(crate) mod failure;
pub(crate) mod fields;
pub(crate) mod model;
pub(crate) mod ray;
pub(crate) mod response;
pub(crate) mod solve;
pub(crate) mod solve_cache;
pub(crate) mod sta;
pub(crate) mod step_control;
pub(crate) mod versions;
