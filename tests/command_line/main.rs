//! The command line without external programs: what is printed and written, refusals, and what the
//! project says of itself.

mod architecture;
mod bad_input;
#[path = "../common/mod.rs"]
mod common;
mod cutting;
mod dependencies;
mod documents;
mod extremes;
mod foreign_files;
mod golden;
mod keys;
mod levels;
mod listings;
mod materials;
mod measuring;
mod messages;
mod moved_run;
mod new_project;
mod notes;
mod several_sheets;
mod silhouettes;
mod springback;
