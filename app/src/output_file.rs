//! Files that a command writes, and their folders.

use anyhow::{Context, Result, ensure};
use std::path::Path;
use support::{unwritten, whole_file};

/// Creates a folder and its missing parents.
pub fn create_folder(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot create the folder {}", folder.display()))
}

/// Creates the folder of a file.
pub fn create_folder_of(file: &Path) -> Result<()> {
    file.parent().map_or(Ok(()), create_folder)
}

/// Writes a file atomically; its folder must exist.
pub fn write(path: &Path, contents: impl AsRef<[u8]>) -> Result<()> {
    Ok(whole_file::write(path, contents.as_ref()).map_err(unwritten(path))?)
}

/// An error if the file exists.
pub fn refuse_existing(path: &Path) -> Result<()> {
    ensure!(
        !path.exists(),
        "{} exists: choose another name, or replace it with --replace",
        path.display()
    );
    Ok(())
}
