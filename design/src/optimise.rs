//! The outer loop, Algorithm 1: how the next design is proposed and when it is accepted.

pub mod adam;
pub mod backing_off;
mod lbfgs_memory;
pub mod outer_loop;
pub mod search;
