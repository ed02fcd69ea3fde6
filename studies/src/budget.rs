//! `kirigami-studies budget`: how often the error of a deployed sheet stays within its budget.

mod drawn_sheet;

use crate::budget::drawn_sheet::drawn_sheet;
use anyhow::Result;
use clap::Args;
use design::scene::SceneConfig;
use kirigami::commands::solve_args::{SolveArgs, task_error};
use kirigami::ui::run_folder;
use mesher::Tier;
use std::path::PathBuf;
use verification::{ElementWindows, SheetErrors, balanced};

/// Measure how often the errors of deployed sheets stay within two standard deviations of their budget
///
/// Draws small sheets, and balances each once with finite elements for its hinges. Writes budget.md and budget.csv. Example:
/// kirigami-studies budget docs/results/budget/sheet.toml --sheets 12
#[derive(Args)]
pub struct BudgetStudy {
    /// Scene (TOML) whose panels, ligaments, supports and loads are drawn
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Number of sheets
    #[arg(long, value_name = "N", default_value_t = 12)]
    sheets: u64,
    /// Mesh tier of the windows
    #[arg(long, value_name = "TIER", default_value = "reference")]
    tier: Tier,
    #[command(flatten)]
    solve: SolveArgs,
    /// Folder for the tables and the solutions
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-budget")]
    out: PathBuf,
}

impl BudgetStudy {
    pub fn run(&self) -> Result<()> {
        let _held = run_folder::hold(&self.out)?;
        let base: SceneConfig = support::toml_file::read(&self.scene)?;
        let windows = ElementWindows {
            tier: self.tier,
            service: &self.solve.service(&self.out)?,
        };
        for number in 0..self.sheets {
            let scene = drawn_sheet(&base, &self.scene, number)?;
            let found = balanced(&scene, &scene.start(), &windows, 1).map_err(task_error);
            match found {
                Ok((found, _)) => println!(
                    "{}",
                    SheetErrors::new(&found, scene.config.title.clone(), self.tier)
                ),
                Err(error) => println!("{number}: {error}"),
            }
        }
        Ok(())
    }
}
