//! The command line: one subcommand a file, errors told once.

mod charts;
mod comparison;
mod database;
mod dataset;
mod demo;
mod deploy;
mod design;
mod doctor;
mod equilibrium;
mod gradient;
mod inspect;
mod interrupt;
mod kept_fits;
mod kept_solves;
mod mesh;
mod pattern;
mod picture;
mod progress;
mod replay;
mod routes;
mod run_folder;
mod slices;
mod solve;
mod study;
mod surrogate;
mod table;
mod tradeoff;
mod train;
mod window_args;

use clap::{Parser, Subcommand};
use database::Unfinished;
use std::process::ExitCode;

/// From a sheet material to a cut sheet: kirigami whose hinges are understood
#[derive(Parser)]
#[command(version, propagate_version = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Demo(demo::DemoCommand),
    Doctor(doctor::DoctorCommand),
    Mesh(mesh::MeshCommand),
    Solve(solve::SolveCommand),
    #[command(subcommand)]
    Study(study::StudyCommand),
    Tradeoff(tradeoff::TradeoffCommand),
    Database(database::DatabaseCommand),
    Dataset(dataset::DatasetCommand),
    Train(train::TrainCommand),
    Surrogate(surrogate::SurrogateCommand),
    Design(design::DesignCommand),
    Pattern(pattern::PatternCommand),
    Deploy(deploy::DeployCommand),
    Equilibrium(equilibrium::EquilibriumCommand),
    Gradient(gradient::GradientCommand),
    Replay(replay::ReplayCommand),
}

/// Exit code of a run that is to be run again: EX_TEMPFAIL of sysexits.h.
const UNFINISHED: u8 = 75;

fn main() -> ExitCode {
    interrupt::end_quietly_when_nobody_reads();
    let result = match Cli::parse().command {
        Command::Demo(command) => command.run(),
        Command::Doctor(command) => command.run(),
        Command::Mesh(command) => command.run(),
        Command::Solve(command) => command.run(),
        Command::Study(command) => command.run(),
        Command::Tradeoff(command) => command.run(),
        Command::Database(command) => command.run(),
        Command::Dataset(command) => command.run(),
        Command::Train(command) => command.run(),
        Command::Surrogate(command) => command.run(),
        Command::Design(command) => command.run(),
        Command::Pattern(command) => command.run(),
        Command::Deploy(command) => command.run(),
        Command::Equilibrium(command) => command.run(),
        Command::Gradient(command) => command.run(),
        Command::Replay(command) => command.run(),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {}", told(&error));
            match error.is::<Unfinished>() {
                true => UNFINISHED.into(),
                false => ExitCode::FAILURE,
            }
        }
    }
}

/// The error and its causes, each said once.
fn told(error: &anyhow::Error) -> String {
    error
        .chain()
        .fold(String::new(), |text, cause| match cause.to_string() {
            cause if text.contains(&cause) => text,
            cause if text.is_empty() => cause,
            cause => format!("{text}: {cause}"),
        })
}
