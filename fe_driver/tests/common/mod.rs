//! Shared by the tests: the shipped film, the paper's hinge, a problem to solve, fake solvers.
#![allow(dead_code)] // every test program uses only a part

use fe_driver::{
    CalculiX, Campaign, Ccx, Ray, RunOptions, Shard, SolveListError, Solved, Tally, WindowProblem,
    finished_windows, run,
};
use hinge::{HingeConstants, HingeDeformation, HingeDesign, Regime, SheetMaterial};
use mesher::Tier;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Duration;

pub fn configs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs")
}

pub fn film() -> SheetMaterial {
    SheetMaterial::load(&configs().join("materials/pet-0.5mm.toml")).unwrap()
}

/// The paper's hinge with the cut angle `alpha_deg`.
pub fn design(alpha_deg: f64) -> HingeDesign {
    HingeConstants::PAPER.hinge(18.0, alpha_deg.to_radians())
}

/// A ray of the paper's hinge on the coarsest mesh.
pub fn problem(alpha_deg: f64, eta: [f64; 2], theta_deg: f64) -> WindowProblem {
    let ray = Ray {
        design: design(alpha_deg),
        end: HingeDeformation::from_eta(eta[0], eta[1], theta_deg.to_radians(), 18.0),
    };
    WindowProblem::new(ray.driven(Regime::Film), &film(), Tier::Tiny)
}

/// The first rays of the campaign `tiny`, with small rotations only.
pub fn campaign(count: usize) -> Campaign {
    let mut campaign = Campaign::load(&configs().join("campaigns/tiny.toml")).unwrap();
    campaign = campaign.first_rays(count);
    campaign.boxes[0].theta_deg = [4.0, 8.0];
    campaign
}

pub fn jobs(folder: &Path) -> Vec<Solved> {
    finished_windows(folder).unwrap().collect::<Result<_, _>>().unwrap()
}

/// The folder of a job.
pub fn job_folder(folder: &Path, id: &str) -> PathBuf {
    folder.join("jobs").join(&id[..2]).join(id)
}

/// The history of a shard that ran on this host; the path does not exist before that.
pub fn history(folder: &Path, name: &str) -> PathBuf {
    let hosts = std::fs::read_dir(folder.join("hosts")).into_iter().flatten();
    let host = hosts.map(|entry| entry.unwrap().path()).next();
    host.unwrap_or_default().join(name)
}

pub const TWO_WORKERS: RunOptions =
    RunOptions { shard: Shard::WHOLE, workers: 2, time_limit: None, retry: false };

/// A run without a stop request.
pub fn run_with(
    options: &RunOptions,
    campaign: &Campaign,
    folder: &Path,
    solver: &CalculiX,
) -> Result<Tally, SolveListError> {
    let never = AtomicBool::new(false);
    Ok(run(campaign, folder, solver, options, &never, &mut |_| {})?.tally)
}

/// The output of ccx for a deck; panics if ccx does not finish.
pub fn solved(deck: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("test.inp"), deck).unwrap();
    let limit = Duration::from_secs(120);
    let ccx = Ccx::find().unwrap();
    let run = ccx.run(folder.path(), "test", limit, &AtomicBool::new(false));
    let run = run.unwrap();
    let log = support::program::tail(&folder.path().join("test.log"));
    assert!(run.finished, "{run:?} {log}");
    std::fs::read_to_string(folder.path().join("test.dat")).unwrap()
}

/// The rows with exactly `fields` numbers in a part of a solver's output.
pub fn rows(text: &str, fields: usize) -> Vec<Vec<f64>> {
    let numbers = |line: &str| line.split_whitespace().map(|f| f.parse().ok()).collect();
    let rows = text.lines().filter_map(numbers);
    rows.filter(|row: &Vec<f64>| row.len() == fields).collect()
}
