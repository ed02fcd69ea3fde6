//! Domain-independent utilities: configuration files, misspelt names, VTK files, atomic file writes, external programs.

#![warn(missing_docs)]

pub mod nearest;
pub mod program;
pub mod sealed_json;
pub mod toml_file;
pub mod vtk;
pub mod whole_file;
