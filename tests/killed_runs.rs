//! A campaign that is killed repeatedly, or whose folder is lost, gives the same database.

mod common;
#[path = "../fe_driver/tests/common/processes.rs"]
mod processes;

use common::Workplace;
use dataset::{Database, Row};
use processes::left_running;
use std::os::unix::fs::PermissionsExt;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Duration;

const CAMPAIGN: &str = "configs/campaigns/demo.toml";

/// Solves a small campaign once and replays the output of gmsh and ccx afterwards.
struct Replay {
    work: Workplace,
}

impl Replay {
    fn new() -> Self {
        let work = Workplace::new();
        work.edit(
            CAMPAIGN,
            &[
                ("count = 40", "count = 6"),
                ("theta_deg = [-5.0, 40.0]", "theta_deg = [4.0, 8.0]"),
                ("median_deg = 20.0", "median_deg = 6.0"),
            ],
        );
        let replay = Self { work };
        std::fs::create_dir(replay.work.path("recorded")).unwrap();
        // The programs run in jobs/<id>/work.
        let id = "id=${PWD%/work}; id=${id##*/}";
        let recorded = replay.work.path("recorded").display().to_string();
        let script = |program: &str, body: &str| {
            let path = replay.work.path(program);
            std::fs::write(&path, format!("#!/bin/sh\n{body}\n")).unwrap();
            std::fs::set_permissions(&path, PermissionsExt::from_mode(0o755)).unwrap();
        };
        script(
            "recording-ccx",
            &format!(
                "[ \"$1\" = -v ] && exec ccx -v\nccx \"$@\" || exit\n{id}\n\
                 cp window.dat {recorded}/$id.dat; cp window.msh {recorded}/$id.msh"
            ),
        );
        script(
            "replaying-ccx",
            &format!(
                "[ \"$1\" = -v ] && echo {} && exit\n{id}; sleep 0.02; echo 'Job finished'\n\
                 exec cp {recorded}/$id.dat window.dat",
                version("ccx", "-v")
            ),
        );
        script(
            "replaying-gmsh",
            &format!(
                "[ \"$1\" = --version ] && echo {} && exit\n{id}\n\
                 exec cp {recorded}/$id.msh window.msh",
                version("gmsh", "--version")
            ),
        );
        let mut record = replay.run("recorded-campaign");
        record.env_remove("KIRIGAMI_GMSH");
        record.env("KIRIGAMI_CCX", replay.work.path("recording-ccx"));
        assert!(record.status().unwrap().success());
        replay
    }

    /// A run in a folder with the replaying programs.
    fn run(&self, folder: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_kirigami"));
        command
            .args([
                "campaign", "run", CAMPAIGN, "--jobs", "2", "--folder", folder,
            ])
            .current_dir(self.work.path(""))
            .env("KIRIGAMI_GMSH", self.work.path("replaying-gmsh"))
            .env("KIRIGAMI_CCX", self.work.path("replaying-ccx"))
            .stdout(Stdio::null());
        command
    }

    /// Number of lines of a campaign's event log.
    fn events(&self, folder: &str) -> usize {
        let history = self.work.path(folder).join("events-1-of-1.jsonl");
        std::fs::read_to_string(history).map_or(0, |text| text.lines().count())
    }

    fn collected(&self, folder: &str) -> Database {
        self.work.output(&format!(
            "campaign collect {CAMPAIGN} --folder {folder} --out {folder}.parquet"
        ));
        Database::read(&self.work.path(&format!("{folder}.parquet"))).unwrap()
    }
}

/// The version that a program prints, which is the number at the end.
fn version(program: &str, flag: &str) -> String {
    let output = Command::new(program).arg(flag).output().unwrap();
    let text = [output.stdout, output.stderr].concat();
    let text = String::from_utf8(text).unwrap();
    let number = |word: &&str| word.starts_with(|c: char| c.is_ascii_digit());
    text.split_whitespace().find(number).unwrap().to_owned()
}

/// The rows without the costs of their solves.
fn timeless(database: &Database) -> Vec<Row> {
    let rows = database.rows().iter().cloned();
    rows.map(|row| Row { cpu_s: 0.0, ..row }).collect()
}

#[test]
fn a_campaign_killed_twenty_times_gives_the_same_database() {
    let replay = Replay::new();
    let whole = timeless(&replay.collected("recorded-campaign"));
    assert!(whole.len() > 60);
    assert!(replay.run("uninterrupted").status().unwrap().success());
    assert_eq!(timeless(&replay.collected("uninterrupted")), whole);

    let mut interrupted = 0;
    for campaign in 0..5 {
        let folder = format!("killed-{campaign}");
        for kill in 0..4 {
            let before = replay.events(&folder);
            let mut run = replay.run(&folder).spawn().unwrap();
            while replay.events(&folder) == before && run.try_wait().unwrap().is_none() {
                std::thread::sleep(Duration::from_millis(1));
            }
            // Within the duration of a solve; multiples of the golden ratio are spread evenly.
            let fraction = (0.618 * f64::from(4 * campaign + kill)).fract();
            std::thread::sleep(Duration::from_millis(60).mul_f64(fraction));
            interrupted += u32::from(run.try_wait().unwrap().is_none());
            run.kill().unwrap();
            run.wait().unwrap();
        }
        assert!(replay.run(&folder).status().unwrap().success());
        assert_eq!(timeless(&replay.collected(&folder)), whole);
        assert_eq!(
            left_running(&replay.work.path(&folder)),
            Vec::<PathBuf>::new()
        );
    }
    assert!(
        interrupted >= 10,
        "only {interrupted} runs were killed before their end"
    );
}

#[test]
fn a_lost_folder_is_restored_from_the_database() {
    let replay = Replay::new();
    let before = replay.collected("recorded-campaign");
    let restore = format!("campaign restore {CAMPAIGN} --from recorded-campaign.parquet");
    let restored = replay.work.output(&format!("{restore} --folder restored"));
    assert!(restored.contains("6 rays restored"), "{restored}");
    // A database has no wall times, so the restored folder has no throughput.
    let status = (replay.work).output(&format!(
        "campaign status {CAMPAIGN} --folder restored --json"
    ));
    let status: serde_json::Value = serde_json::from_str(&status).unwrap();
    assert!(status["throughput"].is_null(), "{status}");
    // Nothing is left to solve, so a missing solver causes no error.
    let mut run = replay.run("restored");
    let outcome = run.env("KIRIGAMI_CCX", replay.work.path("replaying-ccx"));
    std::fs::remove_dir_all(replay.work.path("recorded")).unwrap();
    assert!(outcome.status().unwrap().success());
    let after = replay.collected("restored");
    assert_eq!(after.rows(), before.rows());
    assert_eq!(after.manifest(), before.manifest());

    replay.work.edit(CAMPAIGN, &[("kerf = 0.2", "kerf = 0.3")]);
    let message = replay.work.error(&format!("{restore} --folder other"));
    assert!(
        message.contains("none of the jobs belongs to the campaign"),
        "{message}"
    );
}

#[test]
fn a_run_that_ends_early_has_its_own_exit_code() {
    let replay = Replay::new();
    let mut run = replay.run("short");
    let output = run.args(["--time-limit", "0"]).output().unwrap();
    assert_eq!(output.status.code(), Some(75));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(
        message.contains("6 rays left; run the same command again"),
        "{message}"
    );

    let arguments = format!("{CAMPAIGN} --folder short");
    let refused = replay.work.error(&format!("campaign collect {arguments}"));
    assert!(
        refused.contains("missing: 6 rays not solved yet"),
        "{refused}"
    );
    for shard in ["1/2", "2/2"] {
        let status = replay.run("short").args(["--shard", shard]).status();
        assert!(status.unwrap().success());
    }
    let status = replay
        .work
        .output(&format!("campaign status {arguments} --json"));
    let status: serde_json::Value = serde_json::from_str(&status).unwrap();
    assert_eq!(status["tally"]["complete"], 6);
    assert!(status["throughput"]["rays_per_hour"].as_f64().unwrap() > 0.0);
    let plan = replay
        .work
        .output(&format!("campaign plan {arguments} --json"));
    let plan: serde_json::Value = serde_json::from_str(&plan).unwrap();
    assert_eq!(plan["reasons"], serde_json::json!({}));
}
