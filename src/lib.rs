//! The command line of kirigami: its subcommands.
//!
//! ```
//! use clap::Parser;
//! use kirigami::cli::Cli;
//!
//! assert!(Cli::try_parse_from(["kirigami", "design", "scene.toml", "--steps", "10"]).is_ok());
//! assert!(Cli::try_parse_from(["kirigami", "design", "scene.toml", "--step", "10"]).is_err());
//! ```

// A page in a browser has the studio alone.
#![cfg_attr(target_family = "wasm", allow(dead_code))]

#[cfg(unix)]
pub mod cli;
pub mod commands;
mod fitting;
mod new_project;
mod studio;
pub mod ui;
