//! `kirigami-studies path-costs`: what equilibrium paths cost, for linear sheets of growing size and for learned ones.

mod learned;
mod linear;

use crate::charts::{PathCost, growth};
use crate::cpu_seconds::cpu_seconds;
use anyhow::Result;
use clap::Args;
use design::equilibrium::load_step::{Effort, LoadStep};
use kirigami::ui::picture;
use kirigami::ui::progress::Progress;
use kirigami::ui::run_folder;
use std::path::PathBuf;

/// Measure what equilibrium paths cost, for linear sheets of growing size and for the scenes of learned hinges
///
/// Linear sheets are uniform, with panels of 1 mm, and pulled at the middle of an edge in ten load steps. Learned sheets are those of
/// configs/scenes, with three random designs each and one near each, whose path is followed, or corrected from that of the first.
/// Counts and CPU seconds of one thread, with those of the gradient. Writes path-costs.md and a chart of CPU time
/// against panels. Example: kirigami-studies path-costs --panels 90000
#[derive(Args)]
pub struct PathCostStudy {
    /// Number of panels up to which linear sheets are solved; 90000 panels take 3 min and 4 GB
    #[arg(long, value_name = "N", default_value_t = 10_000)]
    panels: usize,
    /// Folder for the results
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-path-costs")]
    out: PathBuf,
}

impl PathCostStudy {
    pub fn run(&self) -> Result<()> {
        let _held = run_folder::hold(&self.out)?;
        let sheets = linear::sheets(self.panels);
        let bar = Progress::new(sheets.len() + learned::SCENES.len(), "sheets");
        let mut linear = Vec::new();
        for sheet in sheets {
            linear.push(linear::measured(sheet)?);
            bar.show(linear.len(), None, "");
        }
        let mut learned = Vec::new();
        for (done, name) in (1..).zip(learned::SCENES) {
            learned.extend(learned::measured(name)?);
            bar.show(linear.len() + done, None, "");
        }
        bar.finish();
        let page = format!("{}\n{}", linear::table(&linear), learned::table(&learned));
        run_folder::write(&self.out, "path-costs.md", &page)?;
        let linear: Vec<PathCost> = linear.into_iter().map(|measured| measured.cost).collect();
        let random = learned.iter().filter(|row| !row.near);
        let learned: Vec<_> = random.map(|row| (row.panels as f64, row.seconds)).collect();
        let chart = growth(&linear, &learned)?;
        picture::save(&chart, &self.out.join("path-costs"), 1400)?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }
}

/// CPU time of a piece of work (s), and its result. Short work is repeated `repeats` times.
fn timed<T>(repeats: usize, mut work: impl FnMut() -> Result<T>) -> Result<(T, f64)> {
    let begin = cpu_seconds()?;
    for _ in 1..repeats {
        work()?;
    }
    let result = work()?;
    Ok((result, (cpu_seconds()? - begin) / repeats as f64))
}

/// The effort of a whole path.
fn effort(path: &[LoadStep]) -> Effort {
    let total = |of: fn(&Effort) -> usize| path.iter().map(|step| of(&step.effort)).sum();
    Effort {
        iterations: total(|effort| effort.iterations),
        factorisations: total(|effort| effort.factorisations),
        increments: total(|effort| effort.increments),
        rejected: total(|effort| effort.rejected),
    }
}

/// Number of jumps on a path.
fn jumps(path: &[LoadStep]) -> usize {
    path.iter().map(|step| step.jumps).sum()
}
