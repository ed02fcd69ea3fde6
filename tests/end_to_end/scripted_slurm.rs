//! Submissions to a Slurm whose programs are scripts.

use crate::common::{Workplace, failure};
use crate::slurm::{CAMPAIGN, on_slurm};
use std::os::unix::fs::PermissionsExt;
use std::process::{Command, Stdio};
use std::time::Duration;

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
        let mut command = on_slurm(&self.work, arguments);
        let path = std::env::var("PATH").unwrap();
        let bin = self.work.path("bin");
        command.env("PATH", format!("{}:{path}", bin.display()));
        command
    }

    /// The error of a submission, and the number of arrays submitted so far.
    fn submit(&self) -> (String, usize) {
        let submit = format!("{CAMPAIGN} 4 1");
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
    let status = slurm.campaign(CAMPAIGN).output();
    let status = String::from_utf8(status.unwrap().stderr).unwrap();
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
    let submit = format!("{CAMPAIGN} 4 1");
    let submitted = slurm.campaign(&submit).output().unwrap();
    assert!(submitted.status.success(), "{submitted:?}");
    let message = failure(&mut slurm.campaign(&submit));
    assert!(message.contains("array 105;alpha has not ended (1 running)"), "{message}");
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
    let record = slurm.work.path("runs/tiny/slurm/submission");
    for answer in ["Welcome to the cluster", ""] {
        slurm.script("sbatch", &format!("echo '{answer}'"));
        let message = failure(&mut slurm.campaign(&format!("{CAMPAIGN} 4 1")));
        assert!(message.contains(&format!("sbatch printed \"{answer}\"")), "{message}");
        assert!(!record.exists());
    }
    slurm.script("sbatch", "echo 'Welcome to the cluster'; echo 7");
    let submit = format!("{CAMPAIGN} 4 1");
    assert!(slurm.campaign(&submit).status().unwrap().success());
    // An array of which the queue says nothing has not ended.
    slurm.answer("echo 'Welcome to the cluster'");
    let message = failure(&mut slurm.campaign(&submit));
    assert!(message.contains("squeue printed \"Welcome to the cluster\""), "{message}");
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
    for (numbers, tasks) in [("4 1", "4 tasks: "), ("5000 1", "43 tasks: ")] {
        let message = failure(&mut slurm.campaign(&format!("{CAMPAIGN} {numbers}")));
        assert!(message.contains(tasks) && message.contains("MaxArraySize"), "{message}");
    }
    for beyond in ["1000001 1", "1 525601"] {
        let message = failure(&mut slurm.campaign(&format!("{CAMPAIGN} {beyond}")));
        assert!(message.contains("MINUTES are"), "{message}");
    }
}

#[test]
fn two_submissions_at_once_submit_one_array() {
    let slurm = Scripted::new();
    slurm.answer("true");
    let arrays = slurm.work.path("arrays");
    // Until the second submission has failed, the first one waits in `sbatch`, but not without the
    // folder of the test.
    let refused = slurm.work.path("refused");
    slurm.script(
        "sbatch",
        &format!(
            "echo x >> {0}; while [ -e {0} ] && ! [ -e {1} ]; do sleep 0.05; done; echo 7",
            arrays.display(),
            refused.display()
        ),
    );
    let submit = format!("{CAMPAIGN} 4 1");
    let mut first = slurm.campaign(&submit).stdout(Stdio::null()).spawn();
    let first = first.as_mut().unwrap();
    while !arrays.exists() {
        assert!(first.try_wait().unwrap().is_none(), "it ended early");
        std::thread::sleep(Duration::from_millis(20));
    }
    let (message, arrays) = slurm.submit();
    assert!(message.contains("another submission"), "{message}");
    assert_eq!(arrays, 1);
    // Also when the first one is killed and its sbatch goes on.
    first.kill().unwrap();
    first.wait().unwrap();
    assert!(slurm.submit().0.contains("another submission"));
    std::fs::write(refused, "").unwrap();
}

#[test]
fn an_array_whose_submission_was_killed_is_not_submitted_again() {
    let slurm = Scripted::new();
    slurm.answer("true");
    let arrays = slurm.work.path("arrays");
    let array = format!("echo x >> {}", arrays.display());
    let kill = "set -- $(cat /proc/$PPID/stat); kill -9 $4 $PPID";
    slurm.script("sbatch", &format!("{array}; {kill}; echo 7"));
    let submit = format!("{CAMPAIGN} 4 1");
    let killed = slurm.campaign(&submit).status().unwrap();
    assert_eq!(killed.code(), None);
    let folder = slurm.work.path("runs/tiny/slurm");
    assert!(!folder.join("submission").exists());

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
