//! The design objective and its gradient through the equilibria; equations (16) to (20).

pub mod design_problem;
pub mod domain_penalty;
pub mod loss;
pub mod outline_error;
pub mod panel_shape;
pub mod panel_width;
pub mod path_functionals;
pub mod scores;
pub mod target;
