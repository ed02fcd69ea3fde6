//! `kirigami study`: what the choices of each stage cost and are worth.

mod actuations;
mod approaches;
mod capacity;
mod chain;
mod gradient;
mod localisation;
mod noise;
mod optimisers;
mod path;
mod polyester;
mod sheet;
mod silhouettes;
mod solutions;
mod surrogate;
mod trust;
mod window;

use crate::interrupt;
use anyhow::{Result, bail};
use clap::Subcommand;
use design::inverse_design::{Designed, Ended, StepRecord, forget, inverse_design};
use design::scene::Scene;

/// Measure what the choices of a stage cost and are worth
#[derive(Subcommand)]
pub enum StudyCommand {
    Chain(chain::ChainStudy),
    Sheet(sheet::SheetStudy),
    Window(window::WindowStudy),
    Noise(noise::NoiseStudy),
    Path(path::PathStudy),
    Polyester(polyester::PolyesterStudy),
    Gradient(gradient::GradientStudy),
    Solutions(solutions::SolutionStudy),
    Approaches(approaches::ApproachStudy),
    Silhouettes(silhouettes::SilhouetteStudy),
    Optimisers(optimisers::OptimiserStudy),
    Actuations(actuations::ActuationStudy),
    Capacity(capacity::CapacityStudy),
    Localisation(localisation::LocalisationStudy),
    Surrogate(surrogate::SurrogateStudy),
    Trust(trust::TrustStudy),
}

impl StudyCommand {
    pub fn run(&self) -> Result<()> {
        match self {
            Self::Chain(study) => study.run(),
            Self::Sheet(study) => study.run(),
            Self::Window(study) => study.run(),
            Self::Noise(study) => study.run(),
            Self::Path(study) => study.run(),
            Self::Polyester(study) => study.run(),
            Self::Gradient(study) => study.run(),
            Self::Solutions(study) => study.run(),
            Self::Approaches(study) => study.run(),
            Self::Silhouettes(study) => study.run(),
            Self::Optimisers(study) => study.run(),
            Self::Actuations(study) => study.run(),
            Self::Capacity(study) => study.run(),
            Self::Localisation(study) => study.run(),
            Self::Surrogate(study) => study.run(),
            Self::Trust(study) => study.run(),
        }
    }
}

/// The finished search of a scene; one that was stopped or is stuck is no result.
fn designed(scene: &Scene, progress: &mut dyn FnMut(&StepRecord)) -> Result<Designed> {
    let stop = interrupt::stop_flag()?;
    let designed = match inverse_design(scene, stop, progress) {
        // What an earlier study left of other weights or of a changed scene is worth nothing here.
        Err(error) if error.is_of_another_run() => {
            forget(scene)?;
            inverse_design(scene, stop, progress)?
        }
        designed => designed?,
    };
    let title = &scene.config.title;
    match &designed.ended {
        Ended::Completed | Ended::Settled => Ok(designed),
        Ended::Stopped => bail!("stopped; run again to go on"),
        Ended::Stuck { reason } => bail!("{title}: the search is stuck: {reason}"),
    }
}
