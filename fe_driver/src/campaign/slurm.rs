//! Slurm: submits the array of a campaign with the job that collects it, and reports the states of
//! both.
//!
//! The script of both jobs is `configs/cluster/slurm.sh`. Names are its arguments, never a part of
//! its text: neither a shell nor Slurm reads them as commands.

use crate::{read_json, write_json};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::io::ErrorKind;
use std::path::{Path, PathBuf, absolute};
use std::process::Command;
use support::{Fault, FileError, fault, lock_file, refuse, verbose, whole_file};

/// The script of a task and of the job that collects.
const SCRIPT: &str = include_str!("../../../configs/cluster/slurm.sh");

/// The tasks of an array.
#[derive(Clone, Copy, Debug)]
pub struct ArrayTasks {
    /// Number of tasks, each of which solves one shard.
    pub count: usize,
    /// Number of solves that a task runs in parallel, and of its processors.
    pub cores: usize,
    /// Time limit of a task (min).
    pub minutes: u64,
}

/// The jobs of the last submission of a campaign, as sbatch prints them: the id, and the cluster if
/// there are several (`105;alpha`).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Submission {
    /// The array.
    pub array: String,
    /// Number of tasks of the array.
    pub tasks: usize,
    /// The job that collects the database after the array; `None` if it was not submitted.
    pub collect: Option<String>,
}

/// The states of the last submission of a campaign.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ArrayStates {
    /// The array, as in [`Submission`].
    pub array: String,
    /// Number of tasks in each state, in Slurm's words; tasks that Slurm no longer knows are
    /// "unknown".
    pub tasks: BTreeMap<String, usize>,
    /// The job that collects the database; `None` if it was not submitted.
    pub collect: Option<String>,
    /// State of this job; "unknown" if there is none, or if Slurm no longer knows it.
    pub collect_state: String,
}

/// The state of a job that Slurm does not know.
const UNKNOWN: &str = "unknown";
/// The states in which a job has ended; in all others it is waiting or active.
const ENDED: &str = "boot_fail cancelled completed deadline failed node_fail out_of_memory \
    preempted revoked timeout unknown";

fn has_ended(state: &str) -> bool {
    ENDED.split(' ').any(|ended| ended == state)
}

impl ArrayStates {
    /// Whether a task or the collecting job waits or runs.
    fn is_active(&self) -> bool {
        !self.tasks.keys().chain([&self.collect_state]).all(|state| has_ended(state))
    }
}

impl fmt::Display for ArrayStates {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let tasks: Vec<_> = self.tasks.iter().map(|(state, n)| format!("{n} {state}")).collect();
        write!(f, "Slurm array {}: {}; ", self.array, tasks.join(", "))?;
        match &self.collect {
            Some(job) => write!(f, "job {job} to collect: {}", self.collect_state),
            None => write!(f, "no job to collect"),
        }
    }
}

/// The id of a job, and the option that names its cluster, if it has one.
fn parts(job: &str) -> (&str, Option<String>) {
    let (id, cluster) = job.split_once(';').map_or((job, None), |(id, name)| (id, Some(name)));
    (id, cluster.map(|name| format!("--clusters={name}")))
}

/// The command that cancels a job.
fn cancel(job: &str) -> String {
    let (id, cluster) = parts(job);
    let cluster = cluster.map_or(String::new(), |option| option + " ");
    format!("`scancel {cluster}{id}`")
}

/// The job in the answer of sbatch, in which a site may print further lines.
fn job(answer: &str) -> Result<String, Fault> {
    let is_job = |job: &&str| {
        let (id, cluster) = job.split_once(';').unwrap_or((job, "-"));
        let word = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
        is_number(id) && !id.starts_with('0') && !cluster.is_empty() && cluster.chars().all(word)
    };
    let jobs: Vec<_> = answer.lines().map(str::trim).filter(is_job).collect();
    match jobs[..] {
        [job] => Ok(job.to_owned()),
        _ => {
            let what = "the id of a job: `squeue --me` shows whether it is submitted";
            Err(unread("sbatch", answer, what))
        }
    }
}

fn unread(program: &str, answer: &str, what: &str) -> Fault {
    fault!("{program} printed {answer:?}, not {what}")
}

/// The folder of script, logs and the record of the last submission, in the folder of a campaign.
pub fn slurm_folder(campaign_folder: &Path) -> PathBuf {
    campaign_folder.join("slurm")
}

/// Name of the record.
const RECORD: &str = "submission.json";

/// Submits the script twice: as an array of tasks that solve the campaign of the file `campaign`,
/// and as the job that collects the database when all tasks have ended, in any state.
///
/// It is an error if the last submission has not ended, or if Slurm does not say so; if a job of an
/// unrecorded submission has not ended; and while another process submits the same campaign.
pub fn submit_array(
    campaign: &Path,
    campaign_folder: &Path,
    tasks: ArrayTasks,
) -> Result<Submission, Fault> {
    let folder = slurm_folder(campaign_folder);
    std::fs::create_dir_all(&folder).map_err(FileError::at(&folder))?;
    let path = folder.join("submit.lock");
    let lock = lock_file::try_hold(&path).map_err(|error| match error.kind() {
        ErrorKind::WouldBlock => fault!(
            "another `campaign submit` of this campaign is at work: it holds {}",
            path.display()
        ),
        _ => FileError::at(&path)(error).into(),
    })?;
    if let Some(states) = array_states(campaign_folder)?.filter(ArrayStates::is_active) {
        refuse!("{states}: wait until it ends, or cancel it with {}", cancel(&states.array));
    }
    let path = folder.join("array.sh");
    let script = whole_file::write(&path, SCRIPT.as_bytes()).and_then(|()| path.canonicalize());
    let script = script.map_err(FileError::at(&path))?;
    if script.to_str().is_none_or(|name| name.contains(char::is_control)) {
        refuse!(
            "{script:?}: squeue cannot list this name, because of a line break or bytes that are no UTF-8: choose another with \
     --folder"
        );
    }
    refuse_unrecorded(&script)?;
    let sbatch = |options: Vec<String>, verb: &str| {
        let mut command = Command::new("sbatch");
        command.arg("--parsable").args(options);
        let prepared = std::env::current_exe().and_then(|program| {
            let [campaign, home] = [absolute(campaign)?, absolute(campaign_folder)?];
            tasks.write(&mut command, &script, [&program, &campaign, &home], verb);
            // It may outlive this process, and holds the lock until it has submitted.
            command.stdin(lock.try_clone()?);
            Ok(())
        });
        prepared.map_err(FileError::at(&script))?;
        job(&output(&mut command)?)
    };
    let count = tasks.count;
    let array = sbatch(vec![format!("--array=1-{count}")], "run").map_err(|error| {
        match error.to_string() {
            text if text.contains("Invalid job array") => fault!(
    "{count} tasks: {text}; the site allows fewer than its MaxArraySize (`scontrol show config`): choose a smaller \
     --shards"
),
            _ => error,
        }
    })?;
    let mut submission = Submission { array, tasks: count, collect: None };
    // The array is recorded before anything else can fail: otherwise it would be submitted twice.
    write_json(&folder.join(RECORD), &submission)?;
    let (id, cluster) = parts(&submission.array);
    let options = [format!("--dependency=afterany:{id}")].into_iter().chain(cluster);
    let collect = sbatch(options.collect(), "collect").map_err(|error| {
        let (array, cancel) = (&submission.array, cancel(&submission.array));
        fault!("array {array} is submitted, but not the job that collects the database: {error}. Run `kirigami campaign \
             collect` when the array has ended, or cancel it with {cancel}")
    })?;
    submission.collect = Some(collect);
    write_json(&folder.join(RECORD), &submission)?;
    Ok(submission)
}

impl ArrayTasks {
    /// The settings of a job, the script and its arguments: the program with the command `verb`,
    /// the campaign and its folder. In the last tenth of the limit, at most 10 minutes, no solve is
    /// started; a tenth before it, at most a minute, running solves are stopped.
    fn write(self, command: &mut Command, script: &Path, paths: [&Path; 3], verb: &str) {
        let [program, campaign, home] = paths;
        let Self { count, cores, minutes } = self;
        let [reserve, grace] = [600, 60].map(|most| (6 * minutes).min(most));
        let folder = script.parent().unwrap_or(script).to_string_lossy();
        let letter = |c: char| if c.is_alphanumeric() { c } else { '-' };
        let stem = campaign.file_stem().unwrap_or_default();
        let name: String = stem.to_string_lossy().chars().map(letter).collect();
        command.args([
            format!("--job-name={name}"),
            format!("--cpus-per-task={cores}"),
            format!("--time={minutes}"),
            format!("--signal=B:TERM@{grace}"),
            // Slurm replaces what follows a percent sign, also in a path.
            format!("--output={}/%x-%A-%a.log", folder.replace('%', "%%")),
            "--chdir".to_owned(),
        ]);
        command.args(script.parent()).arg(script).arg(count.to_string());
        command.arg(program).args(["campaign", verb]).arg(campaign).arg("--folder").arg(home);
        if verb == "collect" {
            command.arg("--replace");
        } else {
            let limit = minutes as f64 - reserve as f64 / 60.0;
            command.args(["--jobs", &cores.to_string(), "--time-limit", &limit.to_string()]);
        }
    }
}

/// An error if a job that has not ended runs the script: its submission was not recorded.
fn refuse_unrecorded(script: &Path) -> Result<(), Fault> {
    let options = ["--federation", "--states=all", "--format=%F|%T|%o"];
    let queue = listed(Command::new("squeue").arg("--noheader").args(options))?;
    let name = script.to_string_lossy();
    let runs_script = |line: &&str| {
        let command = line.splitn(3, '|').nth(2).unwrap_or_default();
        let arguments = command.strip_prefix(&*name);
        arguments.is_some_and(|rest| rest.is_empty() || rest.starts_with(' '))
    };
    let mut jobs = queue.lines().filter(runs_script).filter_map(state);
    match jobs.find(|(_, state)| !has_ended(state)) {
        None => Ok(()),
        Some((job, _)) => Err(fault!(
            "job {job} runs the script {name} and has not ended, though its submission was stopped before it was recorded: wait \
     until it ends and run `kirigami campaign collect`, or cancel it with {}",
            cancel(&job)
        )),
    }
}

/// The states of the last submission of a campaign; `None` if it was never submitted.
pub fn array_states(campaign_folder: &Path) -> Result<Option<ArrayStates>, Fault> {
    let record = slurm_folder(campaign_folder).join(RECORD);
    let Some(Submission { array, tasks, collect }) = read_json(&record)? else {
        return Ok(None);
    };
    let (id, cluster) = parts(&array);
    let ids: Vec<&str> = [id].into_iter().chain(collect.as_ref().map(|job| parts(job).0)).collect();
    let jobs = [format!("--jobs={}", ids.join(","))].into_iter().chain(cluster);
    let known = known_states(&jobs.collect::<Vec<_>>()).map_err(|error| {
        fault!(
    "Slurm does not say whether array {array} has ended ({error}): try again later; if it has ended, delete {}",
    record.display()
)
    })?;
    let state = |job: &str| known.get(job).map_or(UNKNOWN, String::as_str).to_owned();
    let mut counts = BTreeMap::new();
    for task in 1..=tasks {
        *counts.entry(state(&format!("{id}_{task}"))).or_default() += 1;
    }
    let collect_state = state(ids.get(1).unwrap_or(&""));
    Ok(Some(ArrayStates { tasks: counts, collect_state, array, collect }))
}

/// The states of jobs and tasks by their ids, with the options that name them. A state in the
/// queue, which forgets jobs minutes after their end, takes precedence over a state in the
/// accounting, which not every site keeps, and which learns of jobs late. The error of the queue if
/// the accounting knows none of the jobs.
fn known_states(jobs: &[String]) -> Result<BTreeMap<String, String>, Fault> {
    let list = |program, options: &[&str]| {
        listed(Command::new(program).args(["--noheader", "--array"]).args(options).args(jobs))
    };
    let accounting = list("sacct", &["--allocations", "--parsable2", "--format=JobID,State"]);
    let accounting = accounting.unwrap_or_default();
    let queue = match list("squeue", &["--states=all", "--format=%i|%T"]) {
        // The queue has forgotten all of the jobs.
        Err(error) if error.to_string().contains("Invalid job id") => String::new(),
        Err(_) if accounting.lines().any(|line| state(line).is_some()) => String::new(),
        queue => queue?,
    };
    Ok([accounting, queue].iter().flat_map(|text| text.lines()).filter_map(state).collect())
}

/// The list of jobs that a program of Slurm prints; an error if none of its lines is a job.
fn listed(command: &mut Command) -> Result<String, Fault> {
    let answer = output(command)?;
    if answer.trim().is_empty() || answer.lines().any(|line| state(line).is_some()) {
        return Ok(answer);
    }
    let program = command.get_program().to_string_lossy();
    Err(unread(&program, &answer, "jobs with their states"))
}

/// The id and the state in a line like `12_3|CANCELLED by 1000` or `12|RUNNING|script`.
fn state(line: &str) -> Option<(String, String)> {
    let (job, state) = line.trim().split_once('|')?;
    let state = state.split(['|', ' ']).find(|word| !word.is_empty())?;
    let is_state = state.bytes().all(|byte| byte.is_ascii_uppercase() || byte == b'_');
    (is_state && job.split(['_', '+']).all(is_number))
        .then(|| (job.to_owned(), state.to_lowercase()))
}

fn is_number(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// What a program of Slurm prints.
fn output(command: &mut Command) -> Result<String, Fault> {
    verbose::note(|| format!("running {command:?}"));
    let output = command.output();
    let program = command.get_program().to_string_lossy();
    let output = output.map_err(|source| {
        fault!("cannot start {program}: {source}; is Slurm installed on this host?")
    })?;
    if !output.status.success() {
        refuse!("{program} failed: {}", String::from_utf8_lossy(&output.stderr).trim());
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_of_sbatch_names_one_job_by_the_grammar_or_is_quoted() {
        for (answer, written, cancels) in [
            ("105\n", "105", "`scancel 105`"),
            ("105;alpha\n", "105;alpha", "`scancel --clusters=alpha 105`"),
            ("Welcome to the cluster\n\n105;a-1\n", "105;a-1", "`scancel --clusters=a-1 105`"),
        ] {
            let job = job(answer).unwrap();
            assert_eq!((&*job, &*cancel(&job)), (written, cancels));
        }
        let others = "|\n|Welcome|Submitted batch job 105|0|-1|+5|1_2|105;|;alpha|105;a;b|105;a b|105\n106|1.5";
        for answer in others.split('|') {
            let error = job(answer).unwrap_err().to_string();
            assert!(error.contains(&format!("{answer:?}")), "{error}");
        }
    }

    #[test]
    fn a_line_is_a_job_with_its_state_or_none() {
        let read = |line| state(line).map(|(job, state)| format!("{job} {state}"));
        for (line, expected) in [
            ("12_3|CANCELLED by 1000", "12_3 cancelled"),
            ("12|OUT_OF_MEMORY|/a/array.sh collect", "12 out_of_memory"),
            ("7+0|RUNNING", "7+0 running"),
        ] {
            assert_eq!(read(line).as_deref(), Some(expected));
        }
        for line in ["", "12", "| Welcome |", "12|", "12|see the news", "twelve|RUNNING"] {
            assert_eq!(read(line), None, "{line}");
        }
    }

    /// Names that a shell or a scheduler could take for more than a name.
    const HOSTILE: [&str; 14] = [
        " a  b",
        "$(touch broken-into)${HOME}$HOME",
        "a;touch broken-into&touch broken-into",
        "a|touch broken-into>broken-into<b",
        "#a #b",
        "~",
        "*a{b,c}[a]?!!(a)",
        "-rf",
        "--folder=b",
        "é 折 %j",
        "a\n#SBATCH --wrap=true",
        "a\rb\tc\u{1b}[2J\u{7f}",
        "a'; touch broken-into; '\" --wrap=\"touch broken-into",
        "a`touch broken-into`\\",
    ];

    /// The script gets the words that sbatch gets after it.
    #[test]
    fn hostile_names_are_words_of_a_command() {
        let root = tempfile::tempdir().unwrap();
        let [program, squeue, script] =
            ["kirigami", "squeue", "array.sh"].map(|name| root.path().join(name));
        let recorded = root.path().join("recorded");
        let record = format!("#!/bin/sh\nprintf '%s\\0' \"$@\" > {}\n", recorded.display());
        for (path, text) in [(&program, &*record), (&squeue, "#!/bin/sh\n"), (&script, SCRIPT)] {
            std::fs::write(path, text).unwrap();
            let mode = std::os::unix::fs::PermissionsExt::from_mode(0o755);
            std::fs::set_permissions(path, mode).unwrap();
        }
        let search = format!("{}:{}", root.path().display(), std::env::var("PATH").unwrap());
        let words = |name: &str, verb: &str, tasks: ArrayTasks| -> Vec<String> {
            let mut sbatch = Command::new("sbatch");
            let name = absolute(name).unwrap();
            tasks.write(&mut sbatch, &script, [&program, &name, &name], verb);
            let all: Vec<_> = sbatch.get_args().collect();
            let (_, arguments) = all.split_at(all.iter().position(|word| *word == script).unwrap());
            let mut bash = Command::new("bash");
            bash.args(arguments).current_dir(root.path()).env("PATH", &search);
            if verb == "run" {
                bash.env("SLURM_ARRAY_TASK_ID", "3");
            }
            let output = bash.output().unwrap();
            assert!(output.status.success(), "{output:?}");
            let words = std::fs::read_to_string(&recorded).unwrap();
            words.split_terminator('\0').map(str::to_owned).collect()
        };
        // Slurm checks its time limits every 30 s: even the shortest leaves time for solves.
        let limits = [(1, "0.9"), (10, "9"), (240, "230")].into_iter().cycle();
        for (name, (minutes, limit)) in std::iter::zip(HOSTILE, limits) {
            let path = absolute(name).unwrap().to_str().unwrap().to_owned();
            let tasks = ArrayTasks { count: 32, cores: 4, minutes };
            let campaign = |verb| ["campaign", verb, &path, "--folder", &path].map(str::to_owned);
            let options = ["--jobs", "4", "--time-limit", limit, "--shard", "3/32"];
            let run = [&campaign("run")[..], &options.map(str::to_owned)].concat();
            assert_eq!(words(name, "run", tasks), run);
            let collect = [&campaign("collect")[..], &["--replace".to_owned()]].concat();
            assert_eq!(words(name, "collect", tasks), collect);
            let files = std::fs::read_dir(root.path()).unwrap().count();
            assert_eq!(files, 4, "{name:?} ran a command");
        }
    }
}
