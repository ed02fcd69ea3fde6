//! Equilibria of the sheet under loads, the equilibrium path and the adjoint; equations (10) and (20).

pub mod adjoint;
pub mod branch;
pub mod displacement_control;
pub mod follower;
pub mod force_response;
pub mod hinged_sheet;
pub mod let_go;
pub mod load_step;
pub mod nearby_path;
pub mod newton;
pub mod panel_force;
pub mod path_following;
pub mod place;
pub mod potential;
pub mod refined_solve;
pub mod settings;
pub mod solver;
pub mod sparse_ldl;
pub mod supports;
pub mod tangent;
pub mod weight;
