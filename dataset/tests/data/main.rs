//! Databases on disk, and their exchange as CSV.

#[path = "../common/mod.rs"]
mod common;
mod database;
mod exchange;
mod meshes;
