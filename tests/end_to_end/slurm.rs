//! A campaign on a real Slurm, of one controller and two nodes on this machine: tasks are
//! cancelled, stopped, frozen until their time limit and lost with their node, the controller is
//! restarted, and the database equals the database of one run.

use crate::common::{PROGRAM, Workplace, failure};
use dataset::{Database, SplitPlan};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

pub(crate) const CAMPAIGN: &str = "configs/campaigns/tiny.toml";

/// `scripts/slurm-campaign` in the folder of a test.
pub(crate) fn on_slurm(work: &Workplace, arguments: &str) -> Command {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/slurm-campaign");
    let mut command = Command::new(script);
    command.current_dir(work.path("")).env("KIRIGAMI", PROGRAM);
    command.args(arguments.split_whitespace());
    command
}

/// Slurm and a workplace; dropping it ends every daemon.
struct Cluster {
    slurm: TempDir,
    work: Workplace,
}

impl Cluster {
    fn up() -> Self {
        let (slurm, work) = (tempfile::tempdir().unwrap(), Workplace::new());
        // 40 rays with small rotations, which are solved fast, and the 3 of the spot check.
        work.edit(
            CAMPAIGN,
            &[
                ("theta_deg = [-5.0, 40.0]", "theta_deg = [2.0, 4.0]"),
                ("median_deg = 20.0", "median_deg = 3.0"),
            ],
        );
        let cluster = Self { slurm, work };
        let output = cluster.here("up");
        assert!(output.status.success(), "{}", cluster.logs(&output));
        cluster
    }

    fn here(&self, verb: &str) -> Output {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/slurm-here");
        let mut command = Command::new(script);
        // A daemon that inherits a pipe would keep its reader waiting.
        let errors = std::fs::File::create(self.slurm.path().join("errors")).unwrap();
        command.arg(verb).arg(self.slurm.path());
        command.stdout(Stdio::null()).stderr(errors);
        let status = command.status().unwrap();
        let stderr = std::fs::read(self.slurm.path().join("errors")).unwrap();
        Output { status, stdout: Vec::new(), stderr }
    }

    fn logs(&self, output: &Output) -> String {
        let log = std::fs::read_to_string(self.slurm.path().join("slurmctld.log"));
        String::from_utf8_lossy(&output.stderr).into_owned() + &log.unwrap_or_default()
    }

    /// A command with the cluster's configuration; the program is kirigami if its name is empty.
    fn command(&self, line: &str) -> Command {
        let (program, arguments) = line.split_once(' ').unwrap();
        let mut command = match program {
            "kirigami" => self.work.program(arguments),
            "slurm-campaign" => on_slurm(&self.work, arguments),
            _ => {
                let mut command = Command::new(program);
                command.args(arguments.split(' '));
                command
            }
        };
        command.env("SLURM_CONF", self.slurm.path().join("slurm.conf"));
        command
    }

    fn output(&self, line: &str) -> String {
        let output = self.command(line).output().unwrap();
        assert!(output.status.success(), "{line}: {}", self.logs(&output));
        String::from_utf8(output.stdout).unwrap()
    }

    /// Waits until `ready` is true.
    fn until(&self, what: &str, ready: impl Fn() -> bool) {
        let start = Instant::now();
        while !ready() {
            if start.elapsed() > Duration::from_secs(600) {
                panic!("not within ten minutes: {what}\n{}", self.queue());
            }
            std::thread::sleep(Duration::from_millis(300));
        }
    }

    fn queue(&self) -> String {
        let queue = self.command("squeue --array --states=all").output().unwrap();
        String::from_utf8_lossy(&queue.stdout).into_owned()
    }

    fn submit(&self) -> String {
        self.output(&format!("slurm-campaign {CAMPAIGN} 4 1"))
    }

    /// The states of the tasks and of the collecting job of the last submission, `array` first.
    fn states(&self) -> String {
        self.output(&format!("slurm-campaign {CAMPAIGN}"))
    }

    fn status(&self) -> Value {
        let status = self.output(&format!("kirigami campaign status {CAMPAIGN} --json"));
        serde_json::from_str(&status).unwrap()
    }

    /// The kirigami process of a task, if it runs.
    fn process(&self, task: usize) -> Option<String> {
        let task = format!("SLURM_ARRAY_TASK_ID={task}");
        let processes = environments(self.slurm.path());
        processes.into_iter().find_map(|(pid, environment)| {
            let name = std::fs::read_to_string(format!("/proc/{pid}/comm")).ok()?;
            let ours = name.trim() == "kirigami" && environment.split('\0').any(|it| it == task);
            ours.then_some(pid)
        })
    }

    /// Number of rays solved by shard `task`, in all of its runs.
    fn solved(&self, task: usize) -> usize {
        let hosts = self.work.path("runs/tiny/hosts");
        let host = std::fs::read_dir(hosts).into_iter().flatten().next();
        let folder = host.map_or_else(PathBuf::new, |host| host.unwrap().path());
        let history = folder.join(format!("events-{task}-of-4.jsonl"));
        let text = std::fs::read_to_string(history).unwrap_or_default();
        text.matches("\"ended\":{\"attempt\"").count()
    }

    /// Waits until a task has solved a ray and goes on to the next.
    fn at_work(&self, task: usize) {
        let before = self.solved(task);
        let ready = || self.process(task).is_some() && self.solved(task) > before;
        self.until(&format!("task {task} solves rays"), ready);
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        self.here("down");
    }
}

/// The processes whose environment names `folder`, with their environments.
fn environments(folder: &Path) -> Vec<(String, String)> {
    let folder = folder.to_str().unwrap();
    let processes = std::fs::read_dir("/proc").unwrap().flatten();
    processes
        .filter_map(|process| {
            let environment = std::fs::read(process.path().join("environ")).ok()?;
            let environment = String::from_utf8_lossy(&environment).into_owned();
            let pid = process.file_name().to_string_lossy().into_owned();
            environment.contains(folder).then_some((pid, environment))
        })
        .collect()
}

/// The Parquet file of a database with the CPU times, which no two runs share, set to zero.
fn timeless(path: &Path) -> Vec<u8> {
    let rays = crate::common::timeless(&Database::read(path).unwrap());
    let database = Database::collect(rays, &SplitPlan::default()).unwrap();
    let path = path.with_extension("timeless.parquet");
    database.write(&path, false).unwrap();
    std::fs::read(path).unwrap()
}

/// No name is a part of a line that Slurm or a shell reads.
#[test]
fn hostile_names_reach_slurm_as_they_are() {
    let cluster = Cluster::up();
    let name = "a 'b' \"$HOME\" `c` #;&(x) ~*%j";
    let (campaign, folder) = (format!("configs/campaigns/{name}.toml"), format!("runs/{name}"));
    std::fs::rename(cluster.work.path(CAMPAIGN), cluster.work.path(&campaign)).unwrap();
    let submit = || {
        let mut command = cluster.command("slurm-campaign --folder");
        command.args([&folder, &campaign, "1", "1"]);
        command.output().unwrap()
    };
    cluster.output("scontrol update nodename=n1,n2 state=drain reason=test");
    let output = submit();
    assert!(output.status.success(), "{}", cluster.logs(&output));
    let jobs = cluster.output("scontrol show jobs");
    let logs = cluster.work.path(&folder).join("slurm");
    assert!(jobs.contains("JobName=a--b----HOME---c-----"), "{jobs}");

    // What a submission leaves that was killed before its record.
    std::fs::remove_file(logs.join("submission")).unwrap();
    let refused = submit();
    let message = String::from_utf8(refused.stderr).unwrap();
    assert_eq!(refused.status.code(), Some(1), "{message}");
    assert!(message.contains("array.sh and has not ended"), "{message}");
    cluster.output("scontrol update nodename=n1,n2 state=resume");
    cluster.until("the task starts", || cluster.process(1).is_some());
    let log = || {
        let mut files = std::fs::read_dir(&logs).unwrap();
        files.any(|file| file.unwrap().path().extension().is_some_and(|it| it == "log"))
    };
    cluster.until("its log is in the folder", log);

    let broken = "configs/campaigns/a\n#SBATCH --hold.toml";
    std::fs::copy(cluster.work.path(&campaign), cluster.work.path(broken)).unwrap();
    let mut command = cluster.command("slurm-campaign --folder");
    let message = failure(command.args([&broken.replace(".toml", ""), broken, "1", "1"]));
    assert!(message.contains("cannot list this name"), "{message}");
}

/// Ends the controller and starts it again. (Killed, it would forget the last seconds.)
fn restart_controller(cluster: &Cluster) {
    let pid = std::fs::read_to_string(cluster.slurm.path().join("slurmctld.pid")).unwrap();
    let pid = pid.trim();
    cluster.output(&format!("kill {pid}"));
    let process = Path::new("/proc").join(pid).join("environ");
    cluster.until("the controller has ended", || {
        std::fs::read(&process).is_ok_and(|environment| environment.is_empty()) || !process.exists()
    });
    cluster.output("env PATH=/usr/sbin:/usr/bin:/sbin:/bin slurmctld");
}

#[test]
fn a_campaign_on_slurm_gives_the_database_of_one_run() {
    let cluster = Cluster::up();
    let submitted = cluster.submit();
    assert!(submitted.contains("43 open") && submitted.contains("with 4 tasks"), "{submitted}");
    let (_, array) = submitted.split_once("array ").unwrap();
    let array = array.split(' ').next().unwrap().to_owned();
    let again = format!("slurm-campaign {CAMPAIGN} 4 1");
    let refused = cluster.command(&again).output().unwrap();
    assert_eq!(refused.status.code(), Some(1));
    let message = String::from_utf8(refused.stderr).unwrap();
    assert!(message.contains(&format!("scancel {array}")), "{message}");

    // Tasks 1 and 2 start. A frozen process obeys no signal: Slurm kills it at the time limit.
    cluster.at_work(2);
    let frozen = cluster.process(2).unwrap();
    cluster.output(&format!("kill -STOP {frozen}"));
    cluster.at_work(1);
    cluster.output(&format!("scancel {array}_1"));
    // Task 3 loses its node, and is queued again by Slurm.
    cluster.at_work(3);
    let task = |format: &str, task: usize| {
        let shown =
            cluster.output(&format!("squeue --noheader --format={format} --jobs={array}_{task}"));
        shown.trim().to_owned()
    };
    let node = task("%N", 3);
    cluster.output(&format!("scontrol update nodename={node} state=down reason=test"));
    cluster.until("task 3 is queued again", || task("%T", 3) == "PENDING");
    cluster.until("the node is in service again", || {
        // A node that has returned by itself cannot be resumed.
        let resume = format!("scontrol update nodename={node} state=resume");
        cluster.command(&resume).output().unwrap();
        let state = cluster.output(&format!("sinfo --noheader --nodes={node} --format=%T"));
        !state.contains("down")
    });
    // Task 4 is stopped as by the signal before the time limit, and queues itself again.
    cluster.at_work(4);
    cluster.output(&format!("scancel --signal=TERM --batch {array}_4"));
    cluster.until("task 4 is queued again", || task("%T", 4) == "PENDING");
    restart_controller(&cluster);

    let run = format!("kirigami campaign run {CAMPAIGN} --folder runs/whole");
    cluster.output(&run);
    cluster.output(&format!("kirigami campaign collect {CAMPAIGN} --folder runs/whole"));
    let whole = timeless(&cluster.work.path("runs/whole/hinges.parquet"));

    let collected = cluster.work.path("runs/tiny/hinges.parquet");
    let ended = |state: &str| {
        let states = cluster.states();
        let (first, tasks) = states.split_once(" to collect:\n").unwrap();
        let (_, job) = first.split_once(", job ").unwrap();
        let is = |line: &str, state: &str| line == format!("{job} {state}");
        assert!(state == "completed" || !tasks.lines().any(|line| is(line, "completed")));
        tasks.lines().any(|line| is(line, state)).then(|| tasks.to_owned())
    };
    cluster.until("the array has ended", || ended("failed").is_some());
    let (states, status) = (ended("failed").unwrap(), cluster.status());
    for (state, count) in [("cancelled", 1), ("completed", 2), ("timeout", 1)] {
        assert_eq!(states.matches(state).count(), count, "{states} {}", cluster.queue());
    }
    assert!(status["tally"]["open"].as_u64().unwrap() > 0, "{status}");
    assert!(!collected.exists(), "nothing is collected while rays are missing");
    let log = format!("runs/tiny/slurm/tiny-{array}-4.log");
    let log = std::fs::read_to_string(cluster.work.path(&log)).unwrap();
    assert!(log.contains("run the same command again"), "{log}");

    cluster.submit();
    cluster.until("the database is collected", || ended("completed").is_some());
    assert_eq!(cluster.status()["tally"]["complete"], 43);
    assert!(timeless(&collected) == whole, "the databases differ");
    let [spot, of_whole] = ["tiny", "whole"].map(|folder| {
        let path = format!("runs/{folder}/spot-check.parquet");
        timeless(&cluster.work.path(&path))
    });
    assert!(spot == of_whole, "the spot checks differ");
    let done = cluster.submit();
    assert!(done.contains("nothing is left to solve"), "{done}");

    cluster.here("down");
    let left = environments(cluster.slurm.path());
    assert!(left.is_empty(), "{left:?}");
}
