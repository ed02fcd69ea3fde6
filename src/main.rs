//! The command line: one subcommand a file, errors told once.

mod charts;
mod database;
mod demo;
mod design;
mod doctor;
mod interrupt;
mod mesh;
mod picture;
mod progress;
mod solve;
mod study;
mod table;
mod train;
mod window_args;

use clap::{Parser, Subcommand};
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
    Database(database::DatabaseCommand),
    Train(train::TrainCommand),
    Design(design::DesignCommand),
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Demo(command) => command.run(),
        Command::Doctor(command) => command.run(),
        Command::Mesh(command) => command.run(),
        Command::Solve(command) => command.run(),
        Command::Study(command) => command.run(),
        Command::Database(command) => command.run(),
        Command::Train(command) => command.run(),
        Command::Design(command) => command.run(),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {}", told(&error));
            ExitCode::FAILURE
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
