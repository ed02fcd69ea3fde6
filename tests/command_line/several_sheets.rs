//! `kirigami design` with several scenes or seeds: the table that compares the runs, a stop.

use crate::common::Workplace;
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use std::process::Stdio;
use std::time::{Duration, Instant};

const SCENES: &str = "configs/scenes/pin-7x7.toml configs/scenes/linear-7x7.toml";

/// The cells of the column `name`, one per run.
fn column(work: &Workplace, name: &str) -> Vec<String> {
    let text = work.read("sheets/designs.csv");
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap();
    let at = header.iter().position(|column| *column == name).unwrap();
    lines.map(|cells| cells[at].to_owned()).collect()
}

#[test]
fn all_scenes_are_designed_and_the_table_compares_them() {
    let work = Workplace::new();
    let design = format!("design {SCENES} --steps 1 --out sheets");
    let table = work.output(&design);
    assert!(work.path("sheets/linear-7x7/cut.dxf").exists());
    assert!(table.contains("pin-7x7") && table.contains("linear-7x7"));
    assert_eq!(column(&work, "state"), ["completed", "completed"]);
    assert_eq!(column(&work, "cut file"), ["yes", "yes"]);
    for error in column(&work, "outline error (mm)") {
        assert!(error.parse::<f64>().unwrap() > 0.0, "{error}");
    }
    // A run that fails does not end the others, and is named.
    work.edit(
        "configs/scenes/pin-7x7.toml",
        &[("steps = 150", "steps = 2"), ("opening_deg = 60.0", "opening_deg = 50.0")],
    );
    let message = work.error(&format!("{design} --quiet"));
    assert!(message.contains("1 of 2 runs failed"), "{message}");
    assert!(message.contains("sheets/pin-7x7: ") && message.contains("another run"), "{message}");
    assert_eq!(column(&work, "state"), ["failed", "completed"]);
}

#[test]
fn every_seed_has_its_run() {
    let work = Workplace::new();
    let design = "design configs/scenes/pin-7x7.toml --steps 1 --out sheets --seeds 2";
    let noise = [("steps = 150", "start_noise = 0.1\nsteps = 150")];
    work.edit("configs/scenes/pin-7x7.toml", &noise);
    work.output(design);
    assert_eq!(column(&work, "seed"), ["0", "1"]);
    let losses = column(&work, "loss (mm^2)");
    assert_ne!(losses[0], losses[1]);
    assert!(work.path("sheets/pin-7x7/seed-1/report.json").exists());
}

#[test]
fn a_stopped_command_continues_with_the_runs_that_are_left() {
    let work = Workplace::new();
    let scenes = "configs/scenes/linear-7x7.toml configs/scenes/pin-7x7.toml";
    let design = format!("design {scenes} --out sheets --steps");
    let mut command = work.program(&format!("{design} 100000"));
    let mut child = command.stderr(Stdio::null()).stdout(Stdio::null()).spawn().unwrap();
    let deadline = Instant::now() + Duration::from_secs(60);
    while !work.path("sheets/linear-7x7/state.json").exists() {
        assert!(Instant::now() < deadline, "no state is saved");
        std::thread::sleep(Duration::from_millis(50));
    }
    kill(Pid::from_raw(child.id() as i32), Signal::SIGTERM).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(75));
    let states = column(&work, "state");
    assert!(states.iter().all(|state| state == "stopped" || state == "not run"), "{states:?}");
    let steps = column(&work, "steps")[0].parse::<usize>().unwrap();
    work.output(&format!("{design} {}", steps + 1));
    assert_eq!(column(&work, "state"), ["completed", "completed"]);
    assert_eq!(column(&work, "steps")[0], (steps + 1).to_string());
}

#[test]
fn a_link_or_a_pipe_in_place_of_a_lock_is_refused_at_once() {
    let work = Workplace::new();
    let victim = work.path("victim");
    std::fs::write(&victim, "kept").unwrap();
    std::fs::create_dir(work.path("run")).unwrap();
    std::os::unix::fs::symlink(&victim, work.path("run/lock")).unwrap();
    let design = "design configs/scenes/pin-7x7.toml --steps 1 --out run";
    work.refuses(design, &["run/lock: a link, a pipe"]);
    assert_eq!(std::fs::read_to_string(victim).unwrap(), "kept");
    std::fs::remove_file(work.path("run/lock")).unwrap();
    let pipe = std::process::Command::new("mkfifo").arg(work.path("run/lock")).status();
    assert!(pipe.unwrap().success());
    work.refuses(design, &["run/lock: a link, a pipe"]);
}
