//! The outer loop, Algorithm 1: how the next design is proposed and when it is accepted.

pub mod adam;
pub mod backing_off;
pub(crate) mod gauss_newton;
mod lbfgs_memory;
pub mod outer_loop;
pub mod search;
