//! `kirigami study`: what the choices of each stage cost and are worth.

mod approaches;
mod gradient;
mod optimisers;
mod path;
mod sheet;
mod silhouettes;
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
    Approaches(approaches::ApproachStudy),
    Silhouettes(silhouettes::SilhouetteStudy),
    Optimisers(optimisers::OptimiserStudy),
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
            Self::Approaches(study) => study.run(),
            Self::Silhouettes(study) => study.run(),
            Self::Optimisers(study) => study.run(),
            Self::Surrogate(study) => study.run(),
        }
    }
}
