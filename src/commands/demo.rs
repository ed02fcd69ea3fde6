//! `kirigami demo`: the whole chain once, at a small scale.

use anyhow::{Result, ensure};
use clap::Args;
use std::{
    path::{Path, PathBuf},
    time::Instant,
};
use support::table::Table;

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
    /// `run` runs the command line that consists of some words.
    pub(crate) fn run(&self, run: impl Fn(Vec<&str>) -> Result<()>) -> Result<()> {
        ensure!(
            Path::new(CAMPAIGN).exists(),
            "there is no {CAMPAIGN} here: run the demo in the root folder of the repository"
        );
        let (jobs, database) = (format!("{FOLDER}/campaign"), format!("{FOLDER}/hinges.parquet"));
        let weights = format!("{FOLDER}/surrogate.safetensors");
        let mut times = Vec::new();
        for (what, command) in [
            (
                "solve the hinge windows (gmsh, CalculiX)",
                format!("campaign run {CAMPAIGN} --folder {jobs}"),
            ),
            (
                "collect the database",
                format!("campaign collect {CAMPAIGN} --folder {jobs} --out {database} --replace"),
            ),
            (
                "train the hinge energy",
                format!("train {database} --config {TRAINING} --out {weights} --replace"),
            ),
            ("design the sheet", format!("design {SCENE} --restart")),
        ] {
            println!("\n$ kirigami {command}");
            let start = Instant::now();
            let words = std::iter::once("kirigami").chain(command.split(' '));
            run(words.collect())?;
            times.push((what, start.elapsed().as_secs_f64()));
        }
        println!("\n{}\n{}", time_table(&times), product_table());
        Ok(())
    }
}

fn time_table(times: &[(&str, f64)]) -> Table {
    let mut table = Table::new(["step", "seconds"]);
    for (what, seconds) in times {
        table.row([(*what).to_owned(), format!("{seconds:.1}")]);
    }
    table
}

/// The files that the demo has written.
fn product_table() -> Table {
    let mut table = Table::new(["file", "path", "size (kB)"]);
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
        let size = std::fs::metadata(&path)
            .map_or("missing".into(), |file| format!("{:.1}", file.len() as f64 / 1024.0));
        table.row([what.to_owned(), path.display().to_string(), size]);
    }
    table
}
