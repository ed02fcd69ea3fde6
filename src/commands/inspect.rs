//! `kirigami inspect`: the numbers of the stages of a design.

pub mod scene_args;

use crate::commands::inspect::scene_args::Listed;
use crate::ui::output_file;
use crate::ui::progress::Progress;
use anyhow::{Context, Result};
use clap::{Args, Subcommand};
use output::listing::{self, SpringbackListing, ToleranceListing, ToleranceQuestion};
use std::path::PathBuf;

/// Print the numbers of one stage of a design: pattern, deploy, equilibrium, gradient, tolerances, springback
#[derive(Args)]
pub struct InspectCommand {
    #[command(subcommand)]
    stage: Stage,
}

#[derive(Subcommand)]
enum Stage {
    /// Print cut endpoints, panels and hinges of a scene's sheet, and whether it is valid
    ///
    /// Example: kirigami inspect pattern configs/scenes/linear-7x7.toml --json
    Pattern(Listed),
    /// Print the kinematic deployment of a scene's sheet, with the same opening angle at every hinge
    ///
    /// Example: kirigami inspect deploy configs/scenes/linear-7x7.toml --opening-deg 60 --json
    Deploy(DeployArgs),
    /// Print the equilibria of a scene's sheet along its equilibrium path, and how each was solved
    ///
    /// Example: kirigami inspect equilibrium configs/scenes/linear-7x7.toml --json
    Equilibrium(Listed),
    /// Print the objective of a scene's sheet, term by term, and its gradient
    ///
    /// Example: kirigami inspect gradient configs/scenes/linear-7x7.toml --json
    Gradient(Listed),
    /// Print what errors of cutting do to the deployed sheet, and which tolerances keep it within an error
    ///
    /// Each ligament, the kerf and the thickness are changed by one standard deviation, half of their tolerance, and the
    /// sheet is deployed again; then sheets with all errors at random. Tolerances are those of the scene ([tolerances]). Example: kirigami inspect tolerances runs/a4-plate --ligament 0.05 --samples 200
    /// --picture runs/a4-plate/tolerances.svg
    Tolerances(ToleranceArgs),
    /// Print what stays of the opening when the loads are taken off
    ///
    /// Every hinge springs back elastically towards the deformation that stays by the law of `kirigami surrogate release`, and the sheet
    /// finds its equilibrium without loads, under its weight if it has one. Example: kirigami inspect springback runs/a4-plate
    /// --picture runs/a4-plate/released.svg
    Springback(SpringbackArgs),
}

#[derive(Args)]
struct SpringbackArgs {
    #[command(flatten)]
    listed: Listed,
    /// Draw the sheet without loads to this file (SVG)
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
}

#[derive(Args)]
struct ToleranceArgs {
    #[command(flatten)]
    listed: Listed,
    /// Tolerance +- of the width of every ligament by itself, two standard deviations (mm) [default: that of the scene]
    #[arg(long, value_name = "MM", value_parser = length)]
    ligament: Option<f64>,
    /// Number of sheets with errors at random; 0 for none
    #[arg(long, value_name = "N", default_value_t = 100)]
    samples: usize,
    /// Movement of the corners that is allowed, root mean square, one standard deviation (mm) [default: that of the known errors of
    /// the model]
    #[arg(long, value_name = "MM", value_parser = length)]
    within: Option<f64>,
    /// Draw the deployed sheet to this file, its hinges coloured by the share of their ligament in the variance of the corners
    /// (SVG); needs a tolerance of the ligaments
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
}

fn length(text: &str) -> Result<f64, String> {
    let length = text
        .parse()
        .ok()
        .filter(|length| *length > 0.0 && *length < 1e3);
    length.ok_or_else(|| "must be a length above 0 (mm)".into())
}

#[derive(Args)]
struct DeployArgs {
    #[command(flatten)]
    listed: Listed,
    /// Opening angle of the hinges (deg) [default: that of the design, if the scene has pin hinges]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    opening_deg: Option<f64>,
}

impl InspectCommand {
    pub(crate) fn run(&self) -> Result<()> {
        match &self.stage {
            Stage::Pattern(listed) => {
                let (scene, design, name) = listed.read()?;
                listed.print(name, listing::pattern(&scene.problem()?, &design)?)
            }
            Stage::Deploy(DeployArgs {
                listed,
                opening_deg,
            }) => {
                let (scene, design, name) = listed.read()?;
                let problem = scene.problem()?;
                let opening = (opening_deg.map(f64::to_radians))
                    .or(problem.opening(&design))
                    .context("this scene's hinges are not pins: pass --opening-deg")?;
                listed.print(name, listing::deployment(&problem, &design, opening)?)
            }
            Stage::Equilibrium(listed) => {
                let (scene, design, name) = listed.read()?;
                listed.print(name, listing::equilibrium(&scene.problem()?, &design)?)
            }
            Stage::Tolerances(args) => args.run(),
            Stage::Springback(args) => args.run(),
            Stage::Gradient(listed) => {
                let (scene, design, name) = listed.read()?;
                listed.print(name, listing::gradient(&scene, &scene.problem()?, &design)?)
            }
        }
    }
}

impl SpringbackArgs {
    fn run(&self) -> Result<()> {
        let (scene, design, name) = self.listed.read()?;
        let law = scene
            .springback
            .as_ref()
            .context("the scene names no law of released hinges: set surrogate.springback")?;
        let problem = scene.problem()?;
        let listing = SpringbackListing::new(&scene, &problem, &design, law)?;
        if let Some(path) = &self.picture {
            output_file::write(path, listing.picture(&scene))?;
        }
        self.listed.print(name, listing)
    }
}

impl ToleranceArgs {
    fn run(&self) -> Result<()> {
        let (scene, design, name) = self.listed.read()?;
        let mut tolerances = scene.config.tolerances;
        tolerances.ligament = self.ligament.or(tolerances.ligament);
        let question = ToleranceQuestion {
            tolerances,
            samples: self.samples,
            within: self.within,
        };
        let bar = Progress::new(0, "sheets");
        let mut progress = |done: usize, all: usize| {
            bar.set_total(all);
            bar.show(done, None, "");
        };
        let problem = scene.problem()?;
        let listing = ToleranceListing::new(&scene, &problem, &design, question, &mut progress)?;
        bar.finish();
        if let Some(path) = &self.picture {
            let picture = listing.picture(&scene).context(
                "--picture colours hinges by the errors of their ligaments: give their tolerance, --ligament or [tolerances] ligament (mm)",
            )?;
            output_file::write(path, picture)?;
        }
        self.listed.print(name, listing)
    }
}
