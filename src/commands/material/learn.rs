//! `kirigami material learn`

use crate::{
    commands::pipeline::solve_args::SolveArgs,
    ui::with_unit::{percent, time},
};
use anyhow::Result;
use app::learn::MaterialLearning;
use clap::Args;
use mesher::Tier;
use std::{path::PathBuf, time::Duration};
use verification::Accuracy;

/// Solve hinge windows of a material and train its weights until they are accurate enough
///
/// Starts from weights of another material and solves rays in rounds: 25, 50, 100, ... After each
/// round the weights are fine-tuned, and one network learns the rays and the median of the
/// fine-tuned networks. This network is compared with a spot check: windows at random states of the
/// campaign's region, never trained on. Stops when the root mean square errors of W and of the
/// forces there are small enough, or at the time limit (exit code 75: the same command continues).
/// The folder holds weights.safetensors, the database, the spot check, learn.csv, and the campaign
/// and training that can be edited. Example: kirigami material learn
/// configs/materials/polypropylene-0.8mm.toml --accuracy 1% --time 1h --out runs/polypropylene
#[derive(Args)]
pub(crate) struct LearnCommand {
    /// Material (TOML), as written by `material fit`
    #[arg(value_name = "MATERIAL")]
    material: PathBuf,
    /// Weights of another material, with which fine-tuning starts; once for each file. Several
    /// together have smaller errors than each. One alone is fine-tuned and kept [default: medium
    /// and medium-1 to -3 of data/pet-0.5mm; on a plate tier of data/polypropylene-3mm]
    #[arg(long, value_name = "WEIGHTS")]
    from: Vec<PathBuf>,
    /// Error of W at which the weights are accurate enough, relative to its root mean square
    #[arg(long, value_name = "PERCENT", default_value = "1%", value_parser = percent)]
    accuracy: f64,
    /// The same of the forces: root mean square of the errors of F_a, F_s and M
    #[arg(long, value_name = "PERCENT", default_value = "5%", value_parser = percent)]
    forces: f64,
    /// Start no ray after this time, with its unit: h, min or s; the spot check, running solves and
    /// trainings are finished
    #[arg(long, value_name = "TIME", default_value = "1h", value_parser = time)]
    time: Duration,
    /// Mesh tier of the windows, which also says whether the ligaments belong to a film or to a
    /// plate [default: plate from 1 mm of thickness on, below it default]
    #[arg(long, value_name = "TIER")]
    tier: Option<Tier>,
    /// Number of rays of the first round
    #[arg(long, value_name = "N", default_value_t = 25, value_parser = clap::value_parser!(u16).range(6..))]
    rays: u16,
    /// Number of rays of the spot check, each with 4 states; an accuracy is stated from 6 rays on
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u16).range(3..))]
    spot_rays: u16,
    #[command(flatten)]
    solve: SolveArgs,
    /// Folder for the results; a folder of a stopped run is continued. Its weights come from the
    /// last round of this command
    #[arg(long, value_name = "FOLDER")]
    out: PathBuf,
}

impl LearnCommand {
    pub(crate) fn run(&self) -> Result<()> {
        MaterialLearning {
            material: &self.material,
            from: &self.from,
            accuracy: Accuracy { energy: self.accuracy, forces: self.forces },
            time: self.time,
            tier: self.tier,
            rays: usize::from(self.rays),
            spot_rays: usize::from(self.spot_rays),
            solves: self.solve.solves()?,
            out: &self.out,
        }
        .run()
    }
}
