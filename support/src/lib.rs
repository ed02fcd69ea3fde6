//! Domain-independent utilities: configuration files, atomic file writes, external programs.

#![warn(missing_docs)]

pub mod program;
pub mod sealed_json;
pub mod toml_file;
pub mod whole_file;
