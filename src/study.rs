//! `kirigami study`: what the choices of each stage cost and are worth.

mod actuations;
mod capacity;
mod gradient;
mod localisation;
mod path;
mod sheet;
mod solutions;
mod surrogate;
mod window;

use anyhow::Result;
use clap::Subcommand;

/// Measure what the choices of a stage cost and are worth
#[derive(Subcommand)]
pub enum StudyCommand {
    Sheet(sheet::SheetStudy),
    Window(window::WindowStudy),
    Path(path::PathStudy),
    Gradient(gradient::GradientStudy),
    Solutions(solutions::SolutionStudy),
    Actuations(actuations::ActuationStudy),
    Capacity(capacity::CapacityStudy),
    Localisation(localisation::LocalisationStudy),
    Surrogate(surrogate::SurrogateStudy),
}

impl StudyCommand {
    pub fn run(&self) -> Result<()> {
        match self {
            Self::Sheet(study) => study.run(),
            Self::Window(study) => study.run(),
            Self::Path(study) => study.run(),
            Self::Gradient(study) => study.run(),
            Self::Solutions(study) => study.run(),
            Self::Actuations(study) => study.run(),
            Self::Capacity(study) => study.run(),
            Self::Localisation(study) => study.run(),
            Self::Surrogate(study) => study.run(),
        }
    }
}
