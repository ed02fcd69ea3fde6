//! Several design runs in one command: every scene with every seed, each in a run folder of its
//! own, and one table that compares them.

use crate::{design::ended, failure::Unfinished, progress::Progress, run_folder};
use anyhow::{Context, Result, ensure};
use output::report::Report;
use scene::Scene;
use serde_json::Value;
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
};
use support::{
    regular_file,
    table::Table,
    unread,
    worker_pool::{NoThread, Reports, work_through},
};

/// One design run.
pub struct DesignRun {
    /// The scene file.
    pub file: PathBuf,
    /// The scene, with the seed and the folder of the run.
    pub scene: Scene,
    /// Why this command did not design a sheet that can be cut; `None` if it did.
    pub failure: Option<String>,
}

/// An error if two runs have the same folder.
pub fn refuse_shared_folders(runs: &[DesignRun]) -> Result<()> {
    let mut folders = BTreeSet::new();
    for run in runs {
        let folder = std::path::absolute(run.scene.output())?;
        ensure!(
            folders.insert(folder.clone()),
            "two runs would use the folder {}: give their scenes other names, or another `output`",
            folder.display()
        );
    }
    Ok(())
}

/// Designs runs, `workers` at a time, and compares them in a table, which is written to a folder and
/// printed. An error if a run fails, or is left when `stop` becomes true.
pub fn design_all(
    mut runs: Vec<DesignRun>,
    workers: usize,
    folder: &Path,
    stop: &AtomicBool,
    design: &(dyn Fn(&Scene) -> Result<Report> + Sync),
) -> Result<()> {
    let scenes: Vec<Scene> = runs.iter().map(|run| run.scene.clone()).collect();
    let bar = Progress::new(runs.len(), "designs");
    let (mut left, mut done) = (runs.len(), 0);
    let work = |i: usize, reports: &Reports<(usize, Result<()>)>| {
        let end = design(&scenes[i]).and_then(|report| ended(&scenes[i], &report));
        reports.send((i, end));
    };
    work_through(runs.len(), workers, stop, &work, &mut |(i, ended)| {
        done += 1;
        bar.show(done, None, &runs[i].file.display().to_string());
        if !ended.as_ref().is_err_and(|error| error.is::<Unfinished>()) {
            left -= 1;
            runs[i].failure = ended.err().map(|error| format!("{error:#}"));
        }
        Ok::<_, NoThread>(())
    })?;
    bar.finish();
    let listed = compare(&runs, folder)?;
    println!("{listed}\nwritten to {}", folder.display());
    let failure = |run: &DesignRun| {
        let why = run.failure.as_ref()?;
        Some(format!("\n{}: {why}", run.scene.output().display()))
    };
    let failures: Vec<String> = runs.iter().filter_map(failure).collect();
    let failed = failures.len();
    ensure!(left == 0, Unfinished { left, what: "runs" });
    ensure!(failed == 0, "{failed} of {} runs failed{}", runs.len(), failures.concat());
    Ok(())
}

/// Writes `designs.csv` and `designs.md` to `folder`, and returns the table.
fn compare(runs: &[DesignRun], folder: &Path) -> Result<Table> {
    let mut table = Table::new(COLUMNS);
    for run in runs {
        table.row(cells(run)?);
    }
    run_folder::write_table(folder, "designs", &table)?;
    Ok(table)
}

const COLUMNS: [&str; 11] = [
    "scene",
    "seed",
    "state",
    "steps",
    "outline error (mm)",
    "loss (mm^2)",
    "D_peak",
    "errors",
    "warnings",
    "cut file",
    "folder",
];

/// The cells of a run, from its report.
fn cells(run: &DesignRun) -> Result<[String; COLUMNS.len()]> {
    let folder = run.scene.output();
    let report = report(&folder.join("report.json"))?;
    let state = match (&run.failure, &report["ended"]) {
        (Some(_), _) => "failed".to_owned(),
        (None, Value::String(ended)) => ended.clone(),
        (None, Value::Null) => "not run".to_owned(),
        (None, _) => "stuck".to_owned(),
    };
    let unknown = || "-".to_owned();
    let number = |value: &Value| value.as_f64().map_or_else(unknown, |x| format!("{x:.4}"));
    let found = |severity: &str| match report["warnings"].as_array() {
        Some(all) => {
            let of = all.iter().filter(|it| it["severity"] == severity);
            of.count().to_string()
        }
        None => unknown(),
    };
    let hinges = report["hinges"].as_array().into_iter().flatten();
    let peaks = hinges.filter_map(|hinge| hinge["damage_peak"].as_f64());
    let peak = peaks.reduce(f64::max);
    let steps = report["steps"].as_u64();
    let cut_file = report["cut_file"].as_bool();
    Ok([
        run.file.display().to_string(),
        run.scene.config.optimiser.seed.to_string(),
        state,
        steps.map_or_else(unknown, |steps| steps.to_string()),
        number(&report["after"]["outline_error"]),
        number(&report["after"]["loss"]),
        peak.map_or_else(unknown, |peak| format!("{peak:.3}")),
        found("error"),
        found("warning"),
        cut_file.map_or_else(unknown, |cut| if cut { "yes" } else { "no" }.to_owned()),
        folder.display().to_string(),
    ])
}

/// The report of a run; null if the run has none yet.
fn report(path: &Path) -> Result<Value> {
    if !path.exists() {
        return Ok(Value::Null);
    }
    let text = regular_file::read(path).map_err(unread(path))?;
    serde_json::from_slice(&text).with_context(|| format!("{} is not a report", path.display()))
}
