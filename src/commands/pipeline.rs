//! The subcommands of the pipeline from a material to weights; absent from a build for design
//! alone.

use crate::commands::{campaign, dataset, mesh, solve, surrogate, train, verify};

subcommands! {
    pub(crate) enum PipelineCommand {
        Mesh(mesh::MeshCommand),
        Solve(solve::SolveCommand),
        #[command(subcommand)]
        Campaign(campaign::CampaignCommand),
        #[command(subcommand)]
        Dataset(dataset::DatasetCommand),
        Train(train::TrainCommand),
        #[command(subcommand)]
        Surrogate(surrogate::SurrogateCommand),
        Verify(verify::VerifyCommand),
    }
}
