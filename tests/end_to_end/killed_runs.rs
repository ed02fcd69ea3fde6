//! A campaign that is killed repeatedly, or whose folder is lost, gives the same database.

use crate::common::{Workplace, failure, timeless};
use dataset::{Database, samples};
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use std::os::unix::fs::PermissionsExt;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Duration;
use testkit::{failing_ccx, left_running};

const CAMPAIGN: &str = "configs/campaigns/tiny.toml";

/// Solves a small campaign once and replays the output of gmsh and ccx afterwards.
struct Replay {
    work: Workplace,
}

impl Replay {
    /// Six rays.
    fn new() -> Self {
        Self::of(&[("spot_rays = 3", "spot_rays = 0")])
    }

    /// Six rays of a campaign that is changed further.
    fn of(changes: &[(&str, &str)]) -> Self {
        let work = Workplace::new();
        work.edit(
            CAMPAIGN,
            &[
                ("count = 40", "count = 6"),
                ("theta_deg = [-5.0, 40.0]", "theta_deg = [4.0, 8.0]"),
                ("median_deg = 20.0", "median_deg = 6.0"),
            ],
        );
        work.edit(CAMPAIGN, changes);
        let replay = Self { work };
        std::fs::create_dir(replay.work.path("recorded")).unwrap();
        // The programs run in jobs/<2 digits>/<id>/work-<host>.
        let id = "id=${PWD%/work-*}; id=${id##*/}";
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
        self.campaign("run", folder, "--jobs 2")
    }

    /// A command on a campaign with the replaying programs.
    fn campaign(&self, verb: &str, folder: &str, options: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_kirigami"));
        command
            .args(["campaign", verb, CAMPAIGN, "--folder", folder])
            .args(options.split_whitespace())
            .current_dir(self.work.path(""))
            .env("KIRIGAMI_HOST", "a")
            .env("KIRIGAMI_GMSH", self.work.path("replaying-gmsh"))
            .env("KIRIGAMI_CCX", self.work.path("replaying-ccx"))
            .stdout(Stdio::null());
        command
    }

    /// A command on a file system without locks.
    fn unlocked(&self, command: &Command, trace: &str) -> Command {
        let mut traced = Command::new("strace");
        traced
            .args(["-f", "-qqq", "-o", trace])
            .args(["-e", "trace=flock", "-e", "inject=flock:error=ENOSYS"])
            .arg(command.get_program())
            .args(command.get_args())
            .current_dir(self.work.path(""))
            .stdout(Stdio::null());
        for (variable, value) in command.get_envs() {
            traced.env(variable, value.unwrap());
        }
        traced
    }

    /// Number of lines of a campaign's event log.
    fn events(&self, folder: &str) -> usize {
        let history = self.work.path(folder).join("hosts/a/events-1-of-1.jsonl");
        std::fs::read_to_string(history).map_or(0, |text| text.lines().count())
    }

    /// The work folders and the temporary files in the folders of the jobs of a campaign.
    fn left_over(&self, folder: &str) -> Vec<PathBuf> {
        let entries = |folder: PathBuf| {
            let entries = std::fs::read_dir(folder).unwrap();
            entries.map(|entry| entry.unwrap().path())
        };
        let jobs = entries(self.work.path(folder).join("jobs")).flat_map(entries);
        let left = |path: &PathBuf| {
            let name = path.file_name().unwrap().to_string_lossy();
            name.starts_with("work") || name.ends_with(".partial")
        };
        jobs.flat_map(entries).filter(left).collect()
    }

    fn collected(&self, folder: &str) -> Database {
        let collect = format!("campaign collect {CAMPAIGN} --folder {folder}");
        self.work.output(&collect);
        self.database(&format!("{folder}/hinges"))
    }

    fn database(&self, name: &str) -> Database {
        Database::read(&self.work.path(&format!("{name}.parquet"))).unwrap()
    }
}

/// What a program prints when it is asked for its version.
fn version(program: &str, flag: &str) -> String {
    let output = Command::new(program).arg(flag).output().unwrap();
    let text = [output.stdout, output.stderr].concat();
    String::from_utf8(text).unwrap().trim().to_owned()
}

#[test]
fn a_campaign_killed_twenty_times_gives_the_same_database() {
    let replay = Replay::new();
    let whole = timeless(&replay.collected("recorded-campaign"));
    assert!(samples(&whole).count() > 60);
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
        assert_eq!(left_running(&replay.work.path(&folder)), Vec::<PathBuf>::new());
    }
    assert!(interrupted >= 10, "only {interrupted} runs were killed before their end");
}

/// The rays are on two meshes. The spot check, whose file has four states of a ray, cannot be
/// restored.
#[test]
fn a_lost_folder_is_restored_from_the_database() {
    let replay = Replay::of(&[
        ("spot_rays = 3", "finer_tier = \"small\"\nspot_rays = 3"),
        ("seed = 1", "seed = 1\nfiner = 2"),
    ]);
    let before = replay.collected("recorded-campaign");
    let spot = replay.database("recorded-campaign/spot-check");
    let restore = format!("campaign restore {CAMPAIGN} --from recorded-campaign/hinges.parquet");
    let restored = replay.work.output(&format!("{restore} --folder restored"));
    assert!(restored.contains("8 rays restored"), "{restored}");
    // A database has no wall times, so the restored folder has no throughput.
    let status =
        (replay.work).output(&format!("campaign status {CAMPAIGN} --folder restored --json"));
    let status: serde_json::Value = serde_json::from_str(&status).unwrap();
    assert!(status["throughput"].is_null(), "{status}");
    let collect = format!("campaign collect {CAMPAIGN} --folder restored --out part/rows.parquet");
    let missing = replay.work.error(&collect);
    assert!(missing.contains("3 rays not solved yet"), "{missing}");
    let said = replay.work.output(&format!("{collect} --partial"));
    assert!(said.contains("no spot check: "), "{said}");
    assert_eq!(replay.database("part/rows").rays(), before.rays());
    // Nothing but the spot check is left to solve, so missing output of the other rays causes no
    // error.
    for ray in before.rays() {
        let output = format!("recorded/{}.dat", ray.job);
        std::fs::remove_file(replay.work.path(&output)).unwrap();
    }
    assert!(replay.run("restored").status().unwrap().success());
    let after = replay.collected("restored");
    assert_eq!(after.rays(), before.rays());
    assert_eq!(after.manifest(), before.manifest());
    let again = replay.database("restored/spot-check");
    assert_eq!(timeless(&again), timeless(&spot));

    replay.work.edit(CAMPAIGN, &[("kerf = 0.2", "kerf = 0.3")]);
    let message = replay.work.error(&format!("{restore} --folder other"));
    assert!(message.contains("none of the jobs belongs to the campaign"), "{message}");
}

#[test]
fn a_run_that_ends_early_has_its_own_exit_code() {
    let replay = Replay::new();
    let mut run = replay.run("short");
    let output = run.args(["--time-limit", "0"]).output().unwrap();
    assert_eq!(output.status.code(), Some(75));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("6 rays left; run the same command again"), "{message}");

    let arguments = format!("{CAMPAIGN} --folder short");
    let refused = replay.work.error(&format!("campaign collect {arguments}"));
    assert!(refused.contains("missing: 6 rays not solved yet"), "{refused}");
    for shard in ["1/2", "2/2"] {
        let status = replay.run("short").args(["--shard", shard]).status();
        assert!(status.unwrap().success());
    }
    let status = replay.work.output(&format!("campaign status {arguments} --json"));
    let status: serde_json::Value = serde_json::from_str(&status).unwrap();
    assert_eq!(status["tally"]["complete"], 6);
    assert!(status["throughput"]["rays_per_hour"].as_f64().unwrap() > 0.0);
    let plan = replay.work.output(&format!("campaign plan {arguments} --json"));
    let plan: serde_json::Value = serde_json::from_str(&plan).unwrap();
    assert_eq!(plan["reasons"], serde_json::json!({}));
}

/// The processes of a failed node may still run, and locks of a file system end at the host.
#[test]
fn a_ray_that_two_hosts_solve_is_counted_once() {
    let replay = Replay::new();
    let whole = timeless(&replay.collected("recorded-campaign"));
    let start = |host: &str| replay.run("shared").env("KIRIGAMI_HOST", host).spawn();
    let runs = ["a", "b"].map(|host| start(host).unwrap());
    for mut run in runs {
        assert!(run.wait().unwrap().success());
    }
    assert_eq!(timeless(&replay.collected("shared")), whole);
    let solved = |host: &str| {
        let history = format!("shared/hosts/{host}/events-1-of-1.jsonl");
        let text = std::fs::read_to_string(replay.work.path(&history)).unwrap();
        text.matches("started").count()
    };
    assert!((6..=12).contains(&(solved("a") + solved("b"))));
    assert_eq!(replay.left_over("shared"), Vec::<PathBuf>::new());
}

#[test]
fn a_host_with_another_version_of_a_solver_is_refused() {
    let replay = Replay::new();
    let shard = |shard: &str| {
        let mut run = replay.run("versions");
        run.args(["--shard", shard]);
        run
    };
    assert!(shard("1/2").status().unwrap().success());
    let newer = failing_ccx(&replay.work.path(""), "");
    let text = std::fs::read_to_string(&newer).unwrap();
    std::fs::write(&newer, text.replace("ccx -v", "echo 'This is Version 2.99'")).unwrap();
    let message = failure(shard("2/2").env("KIRIGAMI_HOST", "b").env("KIRIGAMI_CCX", &newer));
    assert!(
        message.contains("b has gmsh")
            && message.contains("ccx 2.99")
            && message.contains("campaign.json"),
        "{message}"
    );
    // Nothing of the first shard was lost.
    assert!(shard("2/2").status().unwrap().success());
    let whole = timeless(&replay.collected("recorded-campaign"));
    assert_eq!(timeless(&replay.collected("versions")), whole);
}

/// Some parallel file systems are mounted without locks.
#[test]
fn a_file_system_without_locks_is_no_obstacle() {
    let replay = Replay::new();
    let design = "design configs/scenes/pin-7x7.toml --steps 1 --force";
    for run in [replay.run("unlocked"), replay.work.program(design)] {
        assert!(replay.unlocked(&run, "trace").status().unwrap().success());
        let trace = std::fs::read_to_string(replay.work.path("trace")).unwrap();
        assert!(trace.contains("ENOSYS"), "{trace}");
    }
    let whole = timeless(&replay.collected("recorded-campaign"));
    assert_eq!(timeless(&replay.collected("unlocked")), whole);
}

/// It is killed before each of its renames in turn: there is always a whole database, and the same
/// command works.
#[test]
fn a_database_that_is_replaced_is_the_old_one_or_the_new_one() {
    let replay = Replay::new();
    let half = replay.run("half").args(["--shard", "1/2"]).status();
    assert!(half.unwrap().success());
    let work = &replay.work;
    let collect = |folder| {
        let collect = format!("campaign collect {CAMPAIGN} --folder {folder} --out kept.parquet");
        collect + " --partial --replace"
    };
    let kept = || replay.database("kept").manifest().hash.clone();
    let [old, new] = ["recorded-campaign", "half"].map(|folder| {
        work.output(&collect(folder));
        kept()
    });
    assert_ne!(old, new);
    let killed_at = |call: &str, number: usize| {
        work.output(&collect("recorded-campaign"));
        let kill = format!("inject={call}:signal=KILL:when={number}");
        let ended = Command::new("strace")
            .args(["-f", "-qqq", "-o", "trace", "-e", &kill])
            .arg(env!("CARGO_BIN_EXE_kirigami"))
            .args(collect("half").split_whitespace())
            .current_dir(work.path(""))
            .stdout(Stdio::null())
            .status();
        (!ended.unwrap().success()).then(kept)
    };
    let mut found = Vec::new();
    // They are counted apart.
    for call in ["rename", "renameat", "renameat2"] {
        found.extend((1..).map_while(|number| killed_at(call, number)));
    }
    // Before each of the three: the Parquet file, the manifest, which decides, and the name of the
    // Parquet file.
    found.sort_by_key(|hash| *hash == new);
    assert_eq!(found, [old.clone(), old, new]);
}

/// Each of them works in folders of its own.
#[test]
fn two_runs_without_locks_give_the_rows_of_one() {
    let replay = Replay::new();
    let run = replay.run("twice");
    let runs = ["first", "second"].map(|trace| replay.unlocked(&run, trace).spawn().unwrap());
    for mut run in runs {
        assert!(run.wait().unwrap().success());
    }
    let both = std::fs::read_to_string(replay.work.path("twice/hosts/a/events-1-of-1.jsonl"));
    assert!(both.unwrap().matches("started").count() > 6);
    let whole = timeless(&replay.collected("recorded-campaign"));
    assert_eq!(timeless(&replay.collected("twice")), whole);
    assert_eq!(replay.left_over("twice"), Vec::<PathBuf>::new());
}

/// A stopped process is what a suspended machine has.
#[test]
fn time_in_which_the_run_is_suspended_does_not_count() {
    let work = Workplace::new();
    let solve = "solve --tier tiny --theta-deg 5";
    work.output(&format!("{solve} --out recorded"));
    let ccx = work.path("suspending-ccx");
    let recorded = work.path("recorded/window.dat");
    let script = format!(
        "#!/bin/sh\n[ \"$1\" = -v ] && exec ccx -v\nkill -STOP $PPID; sleep 4; kill -CONT $PPID; sleep 0.5\n\
         echo 'Job finished'; exec cp {} window.dat\n",
        recorded.display()
    );
    std::fs::write(&ccx, script).unwrap();
    std::fs::set_permissions(&ccx, PermissionsExt::from_mode(0o755)).unwrap();
    let mut solve = work.program(&format!("{solve} --time-limit-s 3"));
    assert!(solve.env("KIRIGAMI_CCX", ccx).status().unwrap().success());
}

#[test]
fn a_stopped_solve_has_the_exit_code_of_stopped_runs() {
    let work = Workplace::new();
    let mut solve = work.program("solve --tier paper --theta-deg 60 --out one");
    let mut solve = solve.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    while !work.path("one/window.sta").exists() {
        assert!(solve.try_wait().unwrap().is_none(), "the solve has ended");
        std::thread::sleep(Duration::from_millis(20));
    }
    kill(Pid::from_raw(solve.id() as i32), Signal::SIGINT).unwrap();
    assert_eq!(solve.wait().unwrap().code(), Some(75));
}
