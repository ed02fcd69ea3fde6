//! Databases on disk, and written as CSV.

#[path = "../common/mod.rs"]
mod common;
mod database;
mod exchange;
mod meshes;
