//! The command line of kirigami: its subcommands.

#![warn(missing_docs)]

pub mod cli;
pub mod commands;
#[cfg(feature = "pipeline")]
mod studio;
pub mod ui;
