//! The subcommands of the pipeline from a material to weights; absent from a build for design alone.

use crate::commands::{campaign, dataset, demo, doctor, mesh, solve, surrogate, train, verify};
use anyhow::Result;
use clap::Subcommand;

#[derive(Subcommand)]
pub enum PipelineCommand {
    Demo(demo::DemoCommand),
    Doctor(doctor::DoctorCommand),
    Mesh(mesh::MeshCommand),
    Solve(solve::SolveCommand),
    Campaign(campaign::CampaignCommand),
    Dataset(dataset::DatasetCommand),
    Train(train::TrainCommand),
    Surrogate(surrogate::SurrogateCommand),
    Verify(verify::VerifyCommand),
}

impl PipelineCommand {
    pub fn run(&self) -> Result<()> {
        match self {
            Self::Demo(command) => command.run(),
            Self::Doctor(command) => command.run(),
            Self::Mesh(command) => command.run(),
            Self::Solve(command) => command.run(),
            Self::Campaign(command) => command.run(),
            Self::Dataset(command) => command.run(),
            Self::Train(command) => command.run(),
            Self::Surrogate(command) => command.run(),
            Self::Verify(command) => command.run(),
        }
    }
}
