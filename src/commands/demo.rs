//! `kirigami demo`: the whole chain once, at a small scale.

use crate::commands::campaign::{CollectCommand, RunCommand};
use crate::commands::design::DesignCommand;
use crate::commands::train::TrainCommand;
use crate::ui::table::{Table, table};
use anyhow::{Result, ensure};
use clap::Args;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Run the whole chain once: window solves, database, training, design, cut file
///
/// Takes a few minutes and writes to runs/demo. Each step is a separate command, printed
/// before it runs.
#[derive(Args)]
pub struct DemoCommand {}

const CAMPAIGN: &str = "configs/campaigns/demo.toml";
const TRAINING: &str = "configs/training/demo.toml";
const SCENE: &str = "configs/scenes/demo.toml";
const FOLDER: &str = "runs/demo";

impl DemoCommand {
    pub(crate) fn run(&self) -> Result<()> {
        ensure!(
            Path::new(CAMPAIGN).exists(),
            "there is no {CAMPAIGN} here: run the demo in the root folder of the repository"
        );
        let file = |name: &str| Path::new(FOLDER).join(name);
        let (jobs, database, weights) = (
            file("campaign"),
            file("hinges.parquet"),
            file("surrogate.safetensors"),
        );
        let (jobs_, database_, weights_) = (jobs.display(), database.display(), weights.display());

        let mut times = Vec::new();
        let mut step = |what: &'static str, command: String, run: &dyn Fn() -> Result<()>| {
            println!("\n$ kirigami {command}");
            let start = Instant::now();
            run()?;
            times.push((what, start.elapsed().as_secs_f64()));
            Ok::<_, anyhow::Error>(())
        };
        step(
            "solve 40 hinge windows (gmsh, CalculiX)",
            format!("campaign run {CAMPAIGN} --folder {jobs_}"),
            &|| RunCommand::new(CAMPAIGN.into(), jobs.clone()).run(),
        )?;
        step(
            "collect the database",
            format!("campaign collect {CAMPAIGN} --folder {jobs_} --out {database_} --replace"),
            &|| CollectCommand::new(CAMPAIGN.into(), jobs.clone(), database.clone()).run(),
        )?;
        step(
            "train the hinge energy",
            format!("train {database_} --config {TRAINING} --out {weights_} --replace"),
            &|| TrainCommand::new(database.clone(), TRAINING.into(), weights.clone()).run(),
        )?;
        step(
            "design the sheet",
            format!("design {SCENE} --restart"),
            &|| DesignCommand::afresh(SCENE.into()).run(),
        )?;

        println!("\n{}\n{}", time_table(&times), product_table());
        Ok(())
    }
}

fn time_table(times: &[(&str, f64)]) -> Table {
    let mut table = table(["step", "seconds"]);
    for (what, seconds) in times {
        table.add_row([(*what).to_owned(), format!("{seconds:.1}")]);
    }
    table
}

/// The files that the demo has written.
fn product_table() -> Table {
    let mut table = table(["file", "path", "size (kB)"]);
    for (what, name) in [
        ("hinge database", "hinges.parquet"),
        ("its manifest", "hinges.json"),
        ("weights of the hinge energy", "surrogate.safetensors"),
        ("their card", "surrogate.json"),
        ("parity plot", "surrogate-parity.png"),
        ("learning curve", "surrogate-learning-curve.png"),
        ("flat pattern", "design/flat.png"),
        ("deployed sheet", "design/deployed.png"),
        ("cut file", "design/cut.dxf"),
        ("report", "design/report.txt"),
        ("page of the run", "design/run.html"),
    ] {
        let path = PathBuf::from(FOLDER).join(name);
        let size = std::fs::metadata(&path).map_or("missing".into(), |file| {
            format!("{:.1}", file.len() as f64 / 1024.0)
        });
        table.add_row([what.to_owned(), path.display().to_string(), size]);
    }
    table
}
