//! The command line: one subcommand per module of [`crate::commands`].

use crate::commands::{
    compare, cut, design, doctor, export, init, inspect, levels, material, studio,
};
#[cfg(feature = "pipeline")]
use crate::commands::{demo, pipeline};
use anyhow::Result;
use app::progress;
use clap::{Parser, Subcommand};
use support::verbose;

/// Design kirigami sheets whose hinges are measured by finite elements
///
/// Material: material. Hinge data: mesh, solve, campaign, dataset. Hinge model: train, surrogate.
/// Sheets: studio, design, cut, inspect, levels, verify, compare, export. Start with: doctor, demo,
/// init.
#[derive(Parser)]
#[command(name = "kirigami", version, propagate_version = true)]
#[command(
    after_help = "Exit codes: 0 done; 1 error; 2 wrong command line; 75 stopped before the work was done, run the same command again."
)]
pub struct Cli {
    /// Show no progress
    #[arg(long, short, global = true)]
    quiet: bool,
    /// Print programs as they are run, files as they are read and written, and the status of every
    /// load step to standard error, instead of progress bars. Example: kirigami --verbose solve
    /// --tier tiny
    #[arg(long, short, global = true, conflicts_with = "quiet")]
    verbose: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    #[command(subcommand)]
    Material(material::MaterialCommand),
    Design(design::DesignCommand),
    Cut(cut::CutCommand),
    Inspect(inspect::InspectCommand),
    Levels(levels::LevelsCommand),
    Compare(compare::CompareCommand),
    Export(export::ExportCommand),
    Init(init::InitCommand),
    Studio(studio::StudioCommand),
    Doctor(doctor::DoctorCommand),
    #[cfg(feature = "pipeline")]
    Demo(demo::DemoCommand),
    #[cfg(feature = "pipeline")]
    #[command(flatten)]
    Pipeline(pipeline::PipelineCommand),
}

impl Cli {
    /// Runs the subcommand.
    pub fn run(&self) -> Result<()> {
        if self.quiet {
            progress::silence();
        }
        if self.verbose {
            verbose::show();
        }
        match &self.command {
            Command::Material(command) => command.run(),
            Command::Design(command) => command.run(),
            Command::Cut(command) => command.run(),
            Command::Inspect(command) => command.run(),
            Command::Levels(command) => command.run(),
            Command::Compare(command) => command.run(),
            Command::Export(command) => command.run(),
            Command::Init(command) => command.run(),
            Command::Studio(command) => command.run(),
            Command::Doctor(command) => command.run(),
            #[cfg(feature = "pipeline")]
            Command::Demo(command) => command.run(|words| Self::try_parse_from(words)?.run()),
            #[cfg(feature = "pipeline")]
            Command::Pipeline(command) => command.run(),
        }
    }
}
