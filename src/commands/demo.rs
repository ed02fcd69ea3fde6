//! `kirigami demo`: the whole chain once, at a small scale.

use anyhow::{Result, ensure};
use clap::Args;
use std::{path::Path, time::Instant};
use support::table::Table;

/// Run the whole chain once: window solves, database, training, design, cut file
///
/// Solves ninety ligaments of a polypropylene plate, trains weights on them and designs a sheet
/// that opens into a heart, in two minutes. Writes to runs/demo; prints the command of each step.
#[derive(Args)]
pub struct DemoCommand {}

const CAMPAIGN: &str = "configs/campaigns/demo.toml";
const SCENE: &str = "configs/scenes/demo.toml";
const FOLDER: &str = "runs/demo";

impl DemoCommand {
    /// `run` runs the command line that consists of some words.
    pub(crate) fn run(&self, run: impl Fn(Vec<&str>) -> Result<()>) -> Result<()> {
        ensure!(
            Path::new(CAMPAIGN).exists(),
            "there is no {CAMPAIGN} here: run the demo in the root folder of the repository"
        );
        let mut times = Vec::new();
        for (what, command) in [
            ("solve the hinge windows (gmsh, CalculiX)", format!("campaign run {CAMPAIGN}")),
            ("collect the database", format!("campaign collect {CAMPAIGN} --replace")),
            ("train the hinge energy", format!("train {CAMPAIGN} --replace")),
            ("design the sheet", format!("design {SCENE} --restart")),
        ] {
            println!("\n$ kirigami {command}");
            let start = Instant::now();
            let words = std::iter::once("kirigami").chain(command.split(' '));
            run(words.collect())?;
            times.push((what, start.elapsed().as_secs_f64()));
        }
        println!("\n{}\nwritten to {FOLDER}; open design/run.html there", time_table(&times));
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
