//! `kirigami man`

use anyhow::{Context, Result};
use clap::{Args, Command};
use clap_mangen::generate_to;
use std::path::PathBuf;

/// Write the man pages, one per command
///
/// Example: kirigami man ~/.local/share/man/man1
#[derive(Args)]
pub struct ManCommand {
    /// Folder to write to
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
}

impl ManCommand {
    /// Writes the pages of the command line `program`.
    pub fn run(&self, program: Command) -> Result<()> {
        std::fs::create_dir_all(&self.folder)
            .and_then(|()| generate_to(program, &self.folder))
            .with_context(|| format!("cannot write man pages to {}", self.folder.display()))
    }
}
