//! The design objective and its gradient through the equilibria; equations (16) to (20).

pub mod centre;
mod design_gradient;
pub mod design_problem;
pub mod hinge_measures;
pub mod loss;
pub mod response;
pub mod scores;
pub mod shape;
pub mod term;
pub mod terms;
