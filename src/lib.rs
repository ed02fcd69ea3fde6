//! The command line of kirigami: its subcommands.

// A page in a browser has the studio alone.
#![cfg_attr(target_family = "wasm", allow(dead_code))]

#[cfg(unix)]
pub mod cli;
pub mod commands;
mod fitting;
mod new_project;
mod studio;
pub mod ui;
