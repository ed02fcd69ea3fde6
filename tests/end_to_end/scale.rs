//! A campaign of many rays, whose folders are written from the shipped rows: the time, memory and
//! files that `status` and `collect` need. It asserts little and prints much: `RAYS=10000 cargo
//! test --release --test end_to_end scale -- --ignored --nocapture`

use crate::common::Workplace;
use dataset::Database;
use fe_driver::{Campaign, CollectedWindow, Solve, ToolVersions, WindowSolve, restore};
use std::os::unix::fs::MetadataExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use toml_edit::value;

const CAMPAIGN: &str = "configs/campaigns/pet-0.5mm.toml";

#[test]
#[ignore = "a measurement of minutes and gigabytes"]
fn the_cost_of_many_rays() {
    let count: u32 = std::env::var("RAYS").map_or(10_000, |text| text.parse().unwrap());
    let work = Workplace::new();
    // One box alone: the shipped rows of other rays are on no finer mesh of it.
    work.edit_campaign(
        CAMPAIGN,
        |campaign| {
            for key in ["finer_tier", "spot_rays", "extra_rays"] {
                campaign.remove(key);
            }
            let boxes = campaign["rays"].as_array_of_tables_mut().unwrap();
            let mut first = true;
            boxes.retain(|_| std::mem::take(&mut first));
        },
        |_, rays| {
            rays["count"] = value(i64::from(count));
            rays.remove("finer");
        },
    );
    let campaign = Campaign::load(&work.path(CAMPAIGN)).unwrap();
    let folder = work.path("runs/pet-0.5mm");

    let database = Database::read(&work.path("data/pet-0.5mm/hinges.parquet")).unwrap();
    let rays: Vec<_> = database.rows().chunk_by(|a, b| a.job == b.job).collect();
    let (gmsh, ccx) = ("4.8.4".to_owned(), "2.20".to_owned());
    let tools = ToolVersions { gmsh, ccx };
    let collected = |(solve, rows): (WindowSolve, &&[dataset::Row])| CollectedWindow {
        id: solve.id(),
        tools: solve.tools,
        solved_tier: solve.problem.tier,
        samples: rows.iter().map(|row| row.sample).collect(),
        cpu_seconds: 1.0,
        failure: None,
    };
    let solves = campaign.solves(&tools).zip(rays.iter().cycle());
    let windows: Vec<CollectedWindow> = solves.map(collected).collect();
    let start = Instant::now();
    restore(&campaign, &folder, &windows).unwrap();
    println!("{count} rays written in {:.1} s", start.elapsed().as_secs_f64());
    drop(windows);
    let (files, bytes) = size(&folder);
    println!("{files} files and folders, {:.1} MB", bytes as f64 / 1e6);
    for command in ["plan", "status", "collect"] {
        let start = Instant::now();
        let memory = memory_mib(&mut work.program(&format!("campaign {command} {CAMPAIGN}")));
        let seconds = start.elapsed().as_secs_f64();
        println!("{command}: {seconds:.1} s, {memory:.0} MiB at most");
    }
    for file in ["hinges.parquet", "hinges.json", "campaign.json"] {
        let bytes = folder.join(file).metadata().unwrap().len();
        println!("{file}: {:.2} MB", bytes as f64 / 1e6);
    }
}

/// Runs a command, which must succeed; the maximum resident memory of its process (MiB). The
/// kernel's own record of a child also counts the memory of the parent, of which it is a copy
/// before it begins.
fn memory_mib(command: &mut Command) -> f64 {
    let mut child = command.stdout(Stdio::null()).spawn().unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut kib = 0.0;
    loop {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        if let Some(line) = line {
            kib = line.trim().trim_end_matches(" kB").parse().unwrap();
        }
        if let Some(ended) = child.try_wait().unwrap() {
            assert!(ended.success());
            return kib / 1024.0;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// The number of files and folders below a folder, and their size on the disk.
fn size(folder: &Path) -> (usize, u64) {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    entries.fold((0, 0), |(files, bytes), entry| {
        let metadata = entry.metadata().unwrap();
        let below = match metadata.is_dir() {
            true => size(&entry.path()),
            false => (0, 0),
        };
        (files + 1 + below.0, bytes + 512 * metadata.blocks() + below.1)
    })
}
