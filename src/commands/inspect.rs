//! `kirigami inspect`: the numbers of the stages of a design.

pub mod scene_args;

use crate::{
    commands::inspect::scene_args::Inspected,
    ui::{exit, print_of, with_unit},
};
use anyhow::{Context, Result};
use clap::{Args, ValueEnum, error::ErrorKind};
use output::listing;
use scene::Level;

/// Print the numbers of one stage of a design
///
/// Examples: kirigami inspect equilibrium configs/scenes/linear-7x7.toml --json;
/// kirigami inspect deploy configs/scenes/linear-7x7.toml --opening-deg 60
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
    /// Print every number as JSON
    #[arg(long)]
    json: bool,
    /// deploy: opening angle of the hinges (deg) [default: the angle of the design, if the scene
    /// has pin hinges]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    opening_deg: Option<f64>,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Stage {
    /// Cut endpoints, panels and hinges of the sheet, and whether it is valid
    Pattern,
    /// The kinematic deployment, with the same opening angle at every hinge
    Deploy,
    /// The equilibria along the equilibrium path, and how each was solved
    Equilibrium,
    /// The objective, term by term, and its gradient
    Gradient,
}

impl InspectCommand {
    pub(crate) fn run(&self) -> Result<()> {
        if self.opening_deg.is_some() && self.stage != Stage::Deploy {
            let message = "--opening-deg is an option of deploy alone\n";
            exit::print_answer(&clap::Error::raw(ErrorKind::ArgumentConflict, message));
        }
        let (scene, design, name) = self.inspected.chosen().read()?;
        let scene = match self.level {
            Some(level) => scene.at_level(level)?,
            None => scene,
        };
        let problem = || scene.problem();
        let listing = match self.stage {
            Stage::Pattern => listing::pattern(&problem()?, &design)?,
            Stage::Deploy => {
                let problem = problem()?;
                let opening = (self.opening_deg.map(f64::to_radians))
                    .or(problem.opening(&design))
                    .context("this scene's hinges are not pins: pass --opening-deg")?;
                listing::deployment(&problem, &design, opening)?
            }
            Stage::Equilibrium => listing::equilibrium(&problem()?, &design)?,
            Stage::Gradient => listing::gradient(&scene, &problem()?, &design)?,
        };
        print_of(self.json, &name, &listing, &listing)
    }
}
