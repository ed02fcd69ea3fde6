//! A campaign on a real Slurm, of one controller and two nodes on this machine: tasks are
//! cancelled, stopped, frozen until their time limit and lost with their node, the controller is
//! restarted, and the database equals the database of one run.

use crate::common::{Workplace, failure};
use dataset::{Database, Row, SplitPlan};
use serde_json::Value;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

const CAMPAIGN: &str = "configs/campaigns/demo.toml";

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
        self.output(&format!("kirigami campaign submit {CAMPAIGN} --shards 4 --time 1"))
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
        let hosts = self.work.path("runs/demo/hosts");
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
    let rows = Database::read(path).unwrap().rows().to_vec();
    let rows = rows.into_iter().map(|row| Row { cpu_s: 0.0, ..row }).collect();
    let database = Database::collect(rows, &SplitPlan::default()).unwrap();
    let path = path.with_extension("timeless.parquet");
    database.write(&path, false).unwrap();
    std::fs::read(path).unwrap()
}

/// A workplace whose `PATH` begins with scripts in place of Slurm's programs: `sbatch` counts the
/// arrays, and fails for the job that collects; the others run `answer`.
struct Scripted {
    work: Workplace,
}

impl Scripted {
    fn new() -> Self {
        let scripted = Self { work: Workplace::new() };
        std::fs::create_dir(scripted.work.path("bin")).unwrap();
        let arrays = scripted.work.path("arrays").display().to_string();
        scripted.script(
            "sbatch",
            &format!("case \"$2\" in --array*) echo x >> {arrays}; echo 7;; *) exit 1;; esac"),
        );
        scripted
    }

    fn script(&self, program: &str, body: &str) {
        let path = self.work.path("bin").join(program);
        std::fs::write(&path, format!("#!/bin/sh\n{body}\n")).unwrap();
        std::fs::set_permissions(&path, PermissionsExt::from_mode(0o755)).unwrap();
    }

    fn answer(&self, answer: &str) {
        for program in ["squeue", "sacct"] {
            self.script(program, answer);
        }
    }

    fn campaign(&self, arguments: &str) -> Command {
        let mut command = self.work.program(&format!("campaign {arguments}"));
        let path = std::env::var("PATH").unwrap();
        let bin = self.work.path("bin");
        command.env("PATH", format!("{}:{path}", bin.display()));
        command
    }

    /// The error of a submission, and the number of arrays submitted so far.
    fn submit(&self) -> (String, usize) {
        let submit = format!("submit {CAMPAIGN} --shards 4 --time 1");
        let message = failure(&mut self.campaign(&submit));
        let arrays = std::fs::read_to_string(self.work.path("arrays")).unwrap();
        (message, arrays.lines().count())
    }
}

#[test]
fn an_array_is_not_submitted_twice() {
    let slurm = Scripted::new();
    slurm.answer("true");
    let (message, arrays) = slurm.submit();
    assert!(message.contains("array 7 is submitted, but not"), "{message}");
    assert_eq!(arrays, 1);
    slurm.answer("exit 1");
    let (message, arrays) = slurm.submit();
    assert!(message.contains("does not say whether array 7"), "{message}");
    assert_eq!(arrays, 1);
    // The accounting learns of a job late: its silence is no evidence.
    slurm.script("sacct", "true");
    assert_eq!(slurm.submit().1, 1);
    let status = slurm.campaign(&format!("status {CAMPAIGN}")).output();
    let status = String::from_utf8(status.unwrap().stdout).unwrap();
    assert!(status.contains("does not say whether array 7"), "{status}");

    slurm.answer("echo '7_1|RUNNING'");
    let (message, arrays) = slurm.submit();
    assert!(message.contains("1 running") && message.contains("scancel 7"), "{message}");
    assert_eq!(arrays, 1);
    // The queue has forgotten it: all of its tasks have ended.
    slurm.answer("true");
    assert_eq!(slurm.submit().1, 2);
}

/// The queue of the default cluster does not know the jobs of another one.
#[test]
fn an_array_on_another_cluster_is_asked_for_there() {
    let slurm = Scripted::new();
    let submissions = slurm.work.path("submissions");
    slurm.script("sbatch", &format!("echo \"$@\" >> {}; echo '105;alpha'", submissions.display()));
    slurm.answer(
        "case \"$*\" in *--clusters=alpha*) echo '105_1|RUNNING';; \
         *--jobs=*) echo 'Invalid job id specified' >&2; exit 1;; esac",
    );
    let submit = format!("submit {CAMPAIGN} --shards 4 --time 1");
    let submitted = slurm.campaign(&submit).output().unwrap();
    assert!(submitted.status.success(), "{submitted:?}");
    let message = failure(&mut slurm.campaign(&submit));
    assert!(message.contains("array 105;alpha: 1 running"), "{message}");
    assert!(message.contains("`scancel --clusters=alpha 105`"), "{message}");
    let submissions = std::fs::read_to_string(submissions).unwrap();
    let [array, collect] = submissions.lines().collect::<Vec<_>>().try_into().unwrap();
    assert!(array.contains("--array=1-4") && !array.contains("--clusters"), "{array}");
    assert!(collect.contains("--dependency=afterany:105 --clusters=alpha"), "{collect}");
}

#[test]
fn an_answer_that_is_not_understood_is_quoted_and_submits_nothing() {
    let slurm = Scripted::new();
    slurm.answer("true");
    let record = slurm.work.path("runs/demo/slurm/submission.json");
    for answer in ["Welcome to the cluster", ""] {
        slurm.script("sbatch", &format!("echo '{answer}'"));
        let message =
            failure(&mut slurm.campaign(&format!("submit {CAMPAIGN} --shards 4 --time 1")));
        assert!(message.contains(&format!("sbatch printed \"{answer}\\n\"")), "{message}");
        assert!(!record.exists());
    }
    slurm.script("sbatch", "echo 'Welcome to the cluster'; echo 7");
    let submit = format!("submit {CAMPAIGN} --shards 4 --time 1");
    assert!(slurm.campaign(&submit).status().unwrap().success());
    // An array of which the queue says nothing has not ended.
    slurm.answer("echo 'Welcome to the cluster'");
    let message = failure(&mut slurm.campaign(&submit));
    assert!(message.contains("squeue printed \"Welcome to the cluster\\n\""), "{message}");
    assert!(message.contains("does not say whether array 7 has ended"), "{message}");
    std::fs::remove_file(&record).unwrap();
    let message = failure(&mut slurm.campaign(&submit));
    assert!(message.contains("squeue printed"), "{message}");
    assert!(!record.exists());
}

/// The campaign has 40 rays and the 3 of its spot check. A site that refuses an array says only
/// that its specification is invalid.
#[test]
fn an_array_has_no_more_tasks_than_rays_and_a_refusal_names_the_limit() {
    let slurm = Scripted::new();
    slurm.answer("true");
    let refused = "Batch job submission failed: Invalid job array specification";
    slurm.script("sbatch", &format!("echo '{refused}' >&2; exit 1"));
    for (shards, tasks) in [(4, 4), (5000, 43)] {
        let submit = format!("submit {CAMPAIGN} --shards {shards} --time 1");
        let message = failure(&mut slurm.campaign(&submit));
        assert!(message.contains(&format!("{tasks} tasks: ")), "{message}");
        assert!(message.contains("MaxArraySize") && message.contains("--shards"), "{message}");
    }
}

#[test]
fn two_submissions_at_once_submit_one_array() {
    let slurm = Scripted::new();
    slurm.answer("true");
    let arrays = slurm.work.path("arrays");
    // Until the second submission has failed, the first one waits in `sbatch`.
    let refused = slurm.work.path("refused");
    slurm.script(
        "sbatch",
        &format!(
            "echo x >> {}; until [ -e {} ]; do sleep 0.05; done; echo 7",
            arrays.display(),
            refused.display()
        ),
    );
    let submit = format!("submit {CAMPAIGN} --shards 4 --time 1");
    let mut first = slurm.campaign(&submit).stdout(Stdio::null()).spawn();
    let first = first.as_mut().unwrap();
    while !arrays.exists() {
        assert!(first.try_wait().unwrap().is_none(), "it ended early");
        std::thread::sleep(Duration::from_millis(20));
    }
    let (message, arrays) = slurm.submit();
    assert!(message.contains("another `campaign submit`"), "{message}");
    assert_eq!(arrays, 1);
    // Also when the first one is killed and its sbatch goes on.
    first.kill().unwrap();
    first.wait().unwrap();
    assert!(slurm.submit().0.contains("another `campaign submit`"));
    std::fs::write(refused, "").unwrap();
}

#[test]
fn an_array_whose_submission_was_killed_is_not_submitted_again() {
    let slurm = Scripted::new();
    slurm.answer("true");
    let arrays = slurm.work.path("arrays");
    let array = format!("echo x >> {}", arrays.display());
    slurm.script("sbatch", &format!("{array}; kill -9 $PPID; echo 7"));
    let submit = format!("submit {CAMPAIGN} --shards 4 --time 1");
    let killed = slurm.campaign(&submit).status().unwrap();
    assert_eq!(killed.code(), None);
    let folder = slurm.work.path("runs/demo/slurm");
    assert!(!folder.join("submission.json").exists());

    let script = folder.join("array.sh").canonicalize().unwrap();
    let line =
        |state: &str, arguments: &str| format!("echo '7|{state}|{}{arguments}'", script.display());
    slurm.answer("exit 1");
    assert!(slurm.submit().0.contains("squeue failed"));
    for arguments in ["", " collect"] {
        slurm.answer(&line("PENDING", arguments));
        let (message, arrays) = slurm.submit();
        assert!(message.contains("scancel 7"), "{message}");
        assert_eq!(arrays, 1);
    }
    // It has ended; another script has not.
    let other = "echo '8|RUNNING|/other/array.sh'; ";
    slurm.script("sbatch", &format!("{array}; echo 9"));
    slurm.answer(&(other.to_owned() + &line("CANCELLED", "")));
    assert!(slurm.campaign(&submit).output().unwrap().status.success());
    assert_eq!(std::fs::read_to_string(arrays).unwrap(), "x\nx\nx\n");
}

/// No name is a part of a line that Slurm or a shell reads.
#[test]
fn hostile_names_reach_slurm_as_they_are() {
    let cluster = Cluster::up();
    let name = "a 'b' \"$HOME\" `c` #;&(x) ~*%j";
    let (campaign, folder) = (format!("configs/campaigns/{name}.toml"), format!("runs/{name}"));
    std::fs::rename(cluster.work.path(CAMPAIGN), cluster.work.path(&campaign)).unwrap();
    let submit = || {
        let mut command = cluster.command("kirigami campaign submit");
        command.args([&campaign, "--folder", &folder, "--shards=1", "--time=1"]);
        command.output().unwrap()
    };
    cluster.output("scontrol update nodename=n1,n2 state=drain reason=test");
    let output = submit();
    assert!(output.status.success(), "{}", cluster.logs(&output));
    let jobs = cluster.output("scontrol show jobs");
    let logs = cluster.work.path(&folder).join("slurm");
    assert!(jobs.contains("JobName=a--b----HOME---c-----"), "{jobs}");

    // What a submission leaves that was killed before its record.
    std::fs::remove_file(logs.join("submission.json")).unwrap();
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
    let mut command = cluster.command("kirigami campaign submit");
    let message = failure(command.args([broken, "--shards=1", "--time=1"]));
    assert!(message.contains("cannot list this name"), "{message}");
}

#[test]
fn a_campaign_on_slurm_gives_the_database_of_one_run() {
    let cluster = Cluster::up();
    let submitted = cluster.submit();
    assert!(submitted.contains("43 rays to solve"), "{submitted}");
    let array = cluster.status()["slurm"]["array"].as_str().unwrap().to_owned();
    let again = format!("kirigami campaign submit {CAMPAIGN} --shards 4 --time 1");
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
    // The controller is restarted. (Killed, it would forget the last seconds.)
    let pid = std::fs::read_to_string(cluster.slurm.path().join("slurmctld.pid")).unwrap();
    let pid = pid.trim();
    cluster.output(&format!("kill {pid}"));
    let process = Path::new("/proc").join(pid).join("environ");
    cluster.until("the controller has ended", || {
        std::fs::read(&process).is_ok_and(|environment| environment.is_empty()) || !process.exists()
    });
    cluster.output("env PATH=/usr/sbin:/usr/bin:/sbin:/bin slurmctld");

    let run = format!("kirigami campaign run {CAMPAIGN} --folder runs/whole");
    cluster.output(&run);
    cluster.output(&format!("kirigami campaign collect {CAMPAIGN} --folder runs/whole"));
    let whole = timeless(&cluster.work.path("runs/whole/hinges.parquet"));

    let collected = cluster.work.path("runs/demo/hinges.parquet");
    let ended = |state: &str| {
        let status = cluster.status();
        assert!(state == "completed" || status["slurm"]["collect_state"] != "completed");
        status["slurm"]["collect_state"] == state
    };
    cluster.until("the array has ended", || ended("failed"));
    let status = cluster.status();
    let expected = serde_json::json!({ "cancelled": 1, "completed": 2, "timeout": 1 });
    assert_eq!(status["slurm"]["tasks"], expected, "{}", cluster.queue());
    assert!(status["tally"]["open"].as_u64().unwrap() > 0, "{status}");
    assert!(!collected.exists(), "nothing is collected while rays are missing");
    let log = format!("runs/demo/slurm/demo-{array}-4.log");
    let log = std::fs::read_to_string(cluster.work.path(&log)).unwrap();
    assert!(log.contains("run the same command again"), "{log}");
    let shown = cluster.output(&format!("kirigami campaign status {CAMPAIGN}"));
    assert!(shown.contains("1 cancelled, 2 completed, 1 timeout"), "{shown}");

    cluster.submit();
    cluster.until("the database is collected", || ended("completed"));
    assert_eq!(cluster.status()["tally"]["complete"], 43);
    assert!(timeless(&collected) == whole, "the databases differ");
    let [spot, of_whole] = ["demo", "whole"].map(|folder| {
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
