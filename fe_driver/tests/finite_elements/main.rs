//! Windows and sheets solved by gmsh and CalculiX.

#[path = "../common/mod.rs"]
mod common;
mod patch_test;
mod verification;
mod whole_sheets;
mod window_solves;
