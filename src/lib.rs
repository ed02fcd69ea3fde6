//! The command line of kirigami: its subcommands.
//!
//! ```
//! use clap::Parser;
//! use kirigami::cli::Cli;
//!
//! assert!(Cli::try_parse_from(["kirigami", "design", "scene.toml", "--steps", "10"]).is_ok());
//! assert!(Cli::try_parse_from(["kirigami", "design", "scene.toml", "--step", "10"]).is_err());
//! ```

#![cfg_attr(not(test), warn(unreachable_pub))]

pub mod cli;
pub mod commands;
pub mod ui;
