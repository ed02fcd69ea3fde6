//! Domain-independent utilities: configuration files, misspelt names, input files, VTK files, atomic file writes, external
//! programs.

#![warn(missing_docs)]

pub mod nearest;
mod processes;
pub mod program;
pub mod regular_file;
pub mod sealed_json;
pub mod toml_file;
pub mod vtk;
pub mod whole_file;
