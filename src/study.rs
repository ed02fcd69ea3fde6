//! `kirigami study`: what the choices of each stage cost and are worth.

mod sheet;
mod window;

use anyhow::Result;
use clap::Subcommand;

/// Measure what the choices of a stage cost and are worth
#[derive(Subcommand)]
pub enum StudyCommand {
    Sheet(sheet::SheetStudy),
    Window(window::WindowStudy),
}

impl StudyCommand {
    pub fn run(&self) -> Result<()> {
        match self {
            Self::Sheet(study) => study.run(),
            Self::Window(study) => study.run(),
        }
    }
}
