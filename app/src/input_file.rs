//! Files that a command reads unless another one is named.

use anyhow::{Context, Result, ensure};
use std::path::Path;

/// An error if there is no file at `path`, which `option` names. A relative path, such as a default
/// path, begins at the current folder.
pub fn require(path: &Path, option: &str) -> Result<()> {
    let here = std::env::current_dir().context("cannot find the current folder")?;
    ensure!(
        path.exists(),
        "there is no {} in {}, the current folder: run the command in the root folder of the repository, or name a file \
         with {option}",
        path.display(),
        here.display()
    );
    Ok(())
}
