//! Domain-independent utilities: configuration files, atomic file writes, external programs.

pub mod program;
pub mod toml_file;
pub mod whole_file;
