//! `kirigami study`: what the choices of each stage cost and are worth.

mod surrogate;
mod window;

use anyhow::Result;
use clap::Subcommand;

/// Measure what the choices of a stage cost and are worth
#[derive(Subcommand)]
pub enum StudyCommand {
    Window(window::WindowStudy),
    Surrogate(surrogate::SurrogateStudy),
}

impl StudyCommand {
    pub fn run(&self) -> Result<()> {
        match self {
            Self::Window(study) => study.run(),
            Self::Surrogate(study) => study.run(),
        }
    }
}
