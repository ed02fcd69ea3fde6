//! `kirigami inspect`: the numbers of the stages of a design.

pub mod scene_args;

use crate::commands::inspect::scene_args::Inspected;
use crate::ui::{exit, output_file, with_unit};
use anyhow::{Context, Result};
use clap::error::ErrorKind;
use clap::{Args, ValueEnum};
use design::pattern::design_vector::DesignVector;
use output::listing::{self, Listing};
use scene::{Level, Scene};
use serde::Serialize;
use std::path::PathBuf;

/// Print the numbers of one stage of a design
///
/// Examples: kirigami inspect equilibrium configs/scenes/linear-7x7.toml --json;
/// kirigami inspect deploy configs/scenes/linear-7x7.toml --opening-deg 60;
/// kirigami inspect springback runs/a4-plate --picture runs/a4-plate/released.svg
#[derive(Args)]
pub struct InspectCommand {
    /// The stage
    #[arg(value_name = "STAGE")]
    stage: Stage,
    #[command(flatten)]
    inspected: Inspected,
    /// The level, instead of the scene's: how much of the hinges is modelled; see `kirigami levels`
    #[arg(long, value_name = "LEVEL", value_parser = with_unit::level())]
    level: Option<Level>,
    /// Print every number as JSON
    #[arg(long)]
    json: bool,
    /// deploy: opening angle of the hinges (deg) [default: the angle of the design, if the scene has pin hinges]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    opening_deg: Option<f64>,
    /// springback: draw the sheet without loads to this file (SVG)
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
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
    /// Residual opening when the loads are taken off: every hinge springs back elastically towards its residual deformation by the law of
    /// `kirigami surrogate release`, and the sheet finds its equilibrium without loads, under its weight if it has one
    Springback,
}

/// A listing with the design that it is of.
#[derive(Serialize)]
struct Of {
    design: String,
    #[serde(flatten)]
    listing: Listing,
}

impl InspectCommand {
    pub(crate) fn run(&self) -> Result<()> {
        self.refuse_options_of_other_stages();
        let (scene, design, name) = self.inspected.read()?;
        let scene = match self.level {
            Some(level) => scene.at_level(level)?,
            None => scene,
        };
        let problem = || scene.problem();
        match self.stage {
            Stage::Pattern => self.print(name, listing::pattern(&problem()?, &design)?),
            Stage::Deploy => {
                let problem = problem()?;
                let opening = (self.opening_deg.map(f64::to_radians))
                    .or(problem.opening(&design))
                    .context("this scene's hinges are not pins: pass --opening-deg")?;
                self.print(name, listing::deployment(&problem, &design, opening)?)
            }
            Stage::Equilibrium => self.print(name, listing::equilibrium(&problem()?, &design)?),
            Stage::Gradient => self.print(name, listing::gradient(&scene, &problem()?, &design)?),
            Stage::Springback => self.print(name, self.springback(&scene, &design)?),
        }
    }

    /// Ends the program if an option is not of the stage.
    fn refuse_options_of_other_stages(&self) {
        for (option, is_given, stage) in [
            ("--opening-deg", self.opening_deg.is_some(), Stage::Deploy),
            ("--picture", self.picture.is_some(), Stage::Springback),
        ] {
            if is_given && self.stage != stage {
                let message = format!("{option} is not an option of this stage\n");
                exit::print_answer(&clap::Error::raw(ErrorKind::ArgumentConflict, message));
            }
        }
    }

    fn print(&self, design: String, listing: Listing) -> Result<()> {
        if self.json {
            let of = Of { design, listing };
            println!("{}", serde_json::to_string_pretty(&of)?);
        } else {
            print!("{design}\n\n{listing}");
        }
        Ok(())
    }

    fn springback(&self, scene: &Scene, design: &DesignVector) -> Result<Listing> {
        let law = scene
            .springback
            .as_ref()
            .context("the scene names no law of released hinges: set surrogate.springback")?;
        let (listing, picture) = listing::springback(scene, &scene.problem()?, design, law)?;
        if let Some(path) = &self.picture {
            output_file::write(path, picture)?;
        }
        Ok(listing)
    }
}
