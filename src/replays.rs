//! Hinge paths of designs, and single hinge states, solved again by finite elements and compared with the surrogate.

pub mod balanced_sheet;
pub mod comparison;
pub mod doubtful_states;
pub mod kept_solves;
pub mod polish;
pub mod routes;
pub mod spot_states;
