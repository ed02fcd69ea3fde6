//! The chain from cut pattern to design gradient: reference cases, closed forms, Taylor tests,
//! extreme input.

mod authors;
mod cases;
mod closed_forms;
mod driven;
mod equilibrium;
mod extension;
mod extreme_sheets;
mod extremes;
mod force_response;
mod gradient;
mod invariance;
mod kinematics;
mod limits;
mod load_steps;
mod nearby_paths;
mod pattern;
mod prelude;
mod pullbacks;
mod random;
mod response;
mod sensitivities;
mod taylor;
mod taylor_test;
mod unloading;
mod weight;
