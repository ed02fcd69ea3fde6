//! `kirigami completions`

use anyhow::Result;
use clap::{Args, Command};
use clap_complete::{Shell, generate};

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
        generate(self.shell, &mut program, name, &mut std::io::stdout());
        Ok(())
    }
}
