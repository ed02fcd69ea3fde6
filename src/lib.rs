//! The command line of kirigami: its subcommands.

#![warn(missing_docs)]

pub mod cli;
pub mod commands;
pub mod ui;
