//! `kirigami completions`

use anyhow::{Context, Result};
use clap::{Args, Command};
use clap_complete::{Shell, generate};
use std::io::Write;

/// Print the completions of a shell
///
/// Example: kirigami completions bash > ~/.local/share/bash-completion/completions/kirigami
#[derive(Args)]
pub struct CompletionsCommand {
    /// The shell
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

impl CompletionsCommand {
    /// Prints the completions of the command line `program`.
    pub fn run(&self, mut program: Command) -> Result<()> {
        let name = program.get_name().to_owned();
        let mut script = Vec::new();
        generate(self.shell, &mut program, name, &mut script);
        let mut output = std::io::stdout();
        let written = output.write_all(&script).and_then(|()| output.flush());
        written.context("cannot write to stdout")
    }
}
