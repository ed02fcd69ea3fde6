//! The program with gmsh, CalculiX, Slurm, strace and a browser.

#[path = "../common/browser.rs"]
mod browser;
#[path = "../common/mod.rs"]
mod common;
#[path = "../../fe_driver/tests/common/fake_solver.rs"]
mod fake_solver;
mod figures;
mod killed_runs;
mod learned_material;
mod main_job;
mod own_data;
mod power_loss;
mod regenerated;
mod run_page;
mod scripted_slurm;
mod slurm;
mod static_page;
mod studio;
mod studio_controls;
mod studio_page;
