//! The command line of kirigami: its subcommands, and the code that `kirigami-studies` shares with them.

#![warn(missing_docs)]

pub mod cli;
pub mod commands;
#[cfg(feature = "pipeline")]
mod studio;
pub mod ui;
