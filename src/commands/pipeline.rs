//! The subcommands of the pipeline from a material to weights; absent from a build for design
//! alone.

mod campaign;
mod dataset;
mod mesh;
mod solve;
pub(super) mod solve_args;
mod surrogate;
mod train;
mod verify;
mod window_args;

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
