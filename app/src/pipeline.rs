//! What the commands from a material to weights do, and finite elements.

pub mod compared_meshes;
pub mod final_search;
pub mod learn;
pub mod solves;
pub mod state_errors;
pub mod train;
pub mod whole_sheet;
