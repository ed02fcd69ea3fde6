//! `kirigami inspect`: the numbers of the stages of a design.

pub mod scene_args;

use crate::{
    commands::inspect::scene_args::Inspected,
    ui::{print_of, with_unit},
};
use anyhow::Result;
use clap::{Args, ValueEnum};
use output::listing;
use scene::Level;

/// Print all numbers of one stage of a design as JSON
///
/// Example: kirigami inspect equilibrium configs/scenes/linear-7x7.toml
#[derive(Args)]
pub struct InspectCommand {
    /// The stage
    #[arg(value_name = "STAGE")]
    stage: Stage,
    #[command(flatten)]
    inspected: Inspected,
    /// The level, instead of the scene's: how much of the hinges is modelled; see `kirigami levels`
    #[arg(long, value_name = "LEVEL", value_parser = with_unit::level_up_to(Level::Fine))]
    level: Option<Level>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Stage {
    /// The equilibria along the equilibrium path, and how each was solved
    Equilibrium,
    /// The objective, term by term, and its gradient
    Gradient,
}

impl InspectCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let (scene, design, name) = self.inspected.chosen().read()?;
        let scene = match self.level {
            Some(level) => scene.at_level(level)?,
            None => scene,
        };
        let problem = scene.problem()?;
        let listing = match self.stage {
            Stage::Equilibrium => listing::equilibrium(&problem, &design)?,
            Stage::Gradient => listing::gradient(&scene, &problem, &design)?,
        };
        print_of(true, &name, &listing, "")
    }
}
