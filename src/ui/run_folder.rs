//! The output folder of a command: created if missing, and locked against a second run.

use anyhow::{Context, Result, bail};
use std::fs::File;
use std::io::ErrorKind;
use std::path::Path;
use support::lock_file;

/// Creates the folder and locks it until the returned file is dropped.
pub fn hold(folder: &Path) -> Result<File> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot create the folder {}", folder.display()))?;
    lock(&folder.join("lock"), || {
        let folder = folder.display();
        format!(
            "another run uses {folder}: wait until it ends, or choose another folder with --out"
        )
    })
}

/// Locks a file, created if missing, until the returned file is dropped; `taken` says what to do if it is locked.
pub fn lock(path: &Path, taken: impl FnOnce() -> String) -> Result<File> {
    match lock_file::try_hold(path) {
        Err(error) if error.kind() == ErrorKind::WouldBlock => bail!(taken()),
        held => held.with_context(|| format!("cannot lock {}", path.display())),
    }
}

/// Writes a file of the folder atomically.
pub fn write(folder: &Path, name: &str, contents: &(impl AsRef<[u8]> + ?Sized)) -> Result<()> {
    let path = folder.join(name);
    support::whole_file::write(&path, contents.as_ref())
        .with_context(|| format!("cannot write {}", path.display()))
}
