//! The output folder of a command: created if missing, and locked against a second run.

use crate::output_file;
use anyhow::{Context, Result, bail};
use std::{fs::File, io::ErrorKind, path::Path};
use support::{lock_file, table::Table};

/// Creates the folder and locks it until the returned file is dropped.
pub fn hold(folder: &Path) -> Result<File> {
    output_file::create_folder(folder)?;
    lock(&folder.join("lock"), || {
        let folder = folder.display();
        format!(
            "another run uses {folder}: wait until it ends, or choose another folder with --out"
        )
    })
}

/// Locks a file, created if missing, until the returned file is dropped; `taken` says what to do if
/// it is locked.
pub fn lock(path: &Path, taken: impl FnOnce() -> String) -> Result<File> {
    match lock_file::try_hold(path) {
        Err(error) if error.kind() == ErrorKind::WouldBlock => bail!(taken()),
        held => held.with_context(|| format!("cannot lock {}", path.display())),
    }
}

/// Writes a file of the folder atomically.
pub fn write(folder: &Path, name: &str, contents: &(impl AsRef<[u8]> + ?Sized)) -> Result<()> {
    output_file::write(&folder.join(name), contents)
}

/// Writes a table to the folder, as `NAME.csv` and `NAME.md`.
pub fn write_table(folder: &Path, name: &str, table: &Table) -> Result<()> {
    write(folder, &format!("{name}.csv"), &table.csv())?;
    write(folder, &format!("{name}.md"), &table.markdown())
}
