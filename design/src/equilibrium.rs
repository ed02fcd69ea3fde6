//! Equilibria of the sheet under loads, the equilibrium path and the adjoint; equations (10) and
//! (20).

pub mod adjoint;
pub mod continuation;
pub mod corrector;
pub mod displacement_control;
pub mod force_response;
pub mod hinged_sheet;
pub mod load_step;
pub mod load_steps;
pub mod mounting;
pub mod newton;
pub mod potential;
pub mod predictor;
pub mod refined_solve;
pub mod settings;
pub mod solver;
pub mod sparse_ldl;
pub mod supports;
pub mod tangent;
pub mod unloading;
pub mod warm_start;
pub mod weight;
