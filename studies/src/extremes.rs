//! `kirigami-studies extremes`: what windows, training, the learned law and the solver do at the limits of their inputs.
//!
//! Every row has a promise, which the study checks, and an outcome. The study fails if a promise is not kept.

mod law_extremes;
mod ratios;
mod sheet_extremes;
mod training_extremes;
mod window_extremes;

use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};
use dataset::Database;
use design::objective::design_problem::Model;
use design::scene::{Scene, SceneConfig};
use fe_driver::CalculiX;
use kirigami::ui::progress::Progress;
use kirigami::ui::run_folder;
use std::path::{Path, PathBuf};
use train::TrainingConfig;

/// Solve windows, train networks, evaluate the learned law and deploy sheets at the limits of their inputs
///
/// Checks what is promised of each row: a solved ray, finite errors, a stated equilibrium, or a refusal with its reason; finite
/// numbers, no damage where it is not known, forces that are the derivative of the energy. Writes a file a table.
/// Example: kirigami-studies extremes windows trainings
#[derive(Args)]
pub struct ExtremesStudy {
    /// Tables to make
    #[arg(value_name = "TABLE", value_enum, default_values_t = Table::value_variants().to_vec())]
    tables: Vec<Table>,
    /// Scene (TOML) with a learned hinge law
    #[arg(
        long,
        value_name = "FILE",
        default_value = "configs/scenes/pet-3x3.toml"
    )]
    scene: PathBuf,
    /// Scene (TOML) with a linear hinge law
    #[arg(
        long,
        value_name = "FILE",
        default_value = "configs/scenes/linear-7x7.toml"
    )]
    linear: PathBuf,
    /// Database of the trainings
    #[arg(
        long,
        value_name = "FILE",
        default_value = "data/pet-0.5mm/reference.parquet"
    )]
    database: PathBuf,
    /// Configuration of the trainings (TOML)
    #[arg(
        long,
        value_name = "FILE",
        default_value = "configs/training/demo.toml"
    )]
    training: PathBuf,
    /// Columns and rows of the large learned sheets
    #[arg(long, value_name = "N", default_value_t = 71)]
    panels: usize,
    /// Folder for the table
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-extremes")]
    out: PathBuf,
}

/// A table of the page.
#[derive(Clone, Copy, ValueEnum)]
enum Table {
    /// Windows: the mesher and the solver.
    Windows,
    /// Trainings.
    Trainings,
    /// The learned law.
    Law,
    /// Equilibria of sheets.
    Sheets,
}

/// What a table says.
struct Checked {
    text: String,
    /// Number of rows whose promise is not kept.
    broken: usize,
}

impl ExtremesStudy {
    pub fn run(&self) -> Result<()> {
        let _held = run_folder::hold(&self.out)?;
        let mut broken = 0;
        for name in &self.tables {
            let table = self.table(*name)?;
            broken += table.broken;
            let name = name.to_possible_value().expect("no table is skipped");
            run_folder::write(&self.out, &format!("{}.md", name.get_name()), &table.text)?;
            println!("{}", table.text);
        }
        println!("written to {}", self.out.display());
        ensure!(broken == 0, "{broken} promises are not kept");
        Ok(())
    }

    fn table(&self, name: Table) -> Result<Checked> {
        let scene = Scene::read(&self.scene)?;
        match name {
            Table::Windows => {
                let solver = CalculiX::find()?;
                window_extremes::table(&solver, &scene.material, &self.out.join("window"))
            }
            Table::Trainings => {
                let training: TrainingConfig = support::toml_file::read(&self.training)?;
                training_extremes::table(&Database::read(&self.database)?, &training)
            }
            Table::Law => {
                let Model::Equilibrium(mechanics) = scene.problem()?.model else {
                    anyhow::bail!("{}: the hinge law has no energy", self.scene.display());
                };
                law_extremes::table(&*mechanics.law, &scene.config.process)
            }
            Table::Sheets => {
                let scenes = [
                    (&scene.config, &*self.scene),
                    (&read(&self.linear)?, &self.linear),
                ];
                let extremes = sheet_extremes::all(scenes, self.panels)?;
                let bar = Progress::new(extremes.len(), "sheets");
                let table =
                    sheet_extremes::table(&extremes, |done, name| bar.show(done, None, name));
                bar.finish();
                table
            }
        }
    }
}

fn read(scene: &Path) -> Result<SceneConfig> {
    Ok(support::toml_file::read(scene)?)
}

/// A reason as a cell of a table.
fn one_line(reason: &str) -> String {
    reason.replace('|', "/").replace('\n', " ")
}

fn kept(promise: bool) -> &'static str {
    if promise { "kept" } else { "NOT KEPT" }
}
