//! Slurm: submits the array of a campaign with the job that collects it, and reports the states of
//! both.

use crate::record_file::{read_json, write_json};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::fs::File;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::Command;
use support::file_error::FileError;
use support::{lock_file, verbose, whole_file};

/// Why an array was not submitted.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum SlurmError {
    #[error("cannot start {program}: {source}; is Slurm installed on this host?")]
    NotFound { program: &'static str, source: std::io::Error },
    #[error("{program} failed: {message}")]
    Refused { program: &'static str, message: String },
    #[error(
        "{tasks} tasks: {message}; the site allows fewer than its MaxArraySize (`scontrol show config`): choose a smaller --shards"
    )]
    TooManyTasks { tasks: usize, message: String },
    #[error("{program} printed {answer:?}, not {what}")]
    Unread { program: &'static str, answer: String, what: &'static str },
    #[error("{0}: wait until it ends, or cancel it with `{cancel}`", cancel = .0.array.cancel())]
    Active(ArrayStates),
    #[error(
        "Slurm does not say whether array {array} has ended ({source}): try again later; if it has ended, delete {record}",
        record = .record.display()
    )]
    Silent { array: JobId, record: PathBuf, source: Box<SlurmError> },
    #[error(
        "job {job} runs the script {script} and has not ended, though its submission was stopped before it was recorded: \
         wait until it ends and run `kirigami campaign collect`, or cancel it with `scancel {job}`",
        script = .script.display()
    )]
    Unrecorded { job: String, script: PathBuf },
    #[error("another `campaign submit` of this campaign is at work: it holds {}", .0.display())]
    Busy(PathBuf),
    #[error(
        "array {array} is submitted, but not the job that collects the database: {source}. Run `kirigami campaign \
         collect` when the array has ended, or cancel it with `{cancel}`",
        cancel = .array.cancel()
    )]
    NotCollected { array: JobId, source: Box<SlurmError> },
    #[error(transparent)]
    File(#[from] FileError),
}

/// A job as sbatch prints it: its id, and its cluster if there are several (`105;alpha`).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String")]
pub struct JobId(String);

impl JobId {
    fn parts(&self) -> (&str, Option<&str>) {
        self.0.split_once(';').map_or((&self.0, None), |(id, cluster)| (id, Some(cluster)))
    }

    /// The option that names the cluster to a program of Slurm.
    fn clusters(&self) -> Option<String> {
        self.parts().1.map(|cluster| format!("--clusters={cluster}"))
    }

    fn cancel(&self) -> String {
        let clusters = self.clusters().map_or(String::new(), |option| option + " ");
        format!("scancel {clusters}{}", self.parts().0)
    }
}

impl TryFrom<String> for JobId {
    type Error = SlurmError;

    /// Reads the answer of sbatch, in which a site may print further lines.
    fn try_from(answer: String) -> Result<Self, SlurmError> {
        let is_job = |job: &Self| {
            let (id, cluster) = job.parts();
            let word = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
            let is_name = |name: &str| !name.is_empty() && name.chars().all(word);
            is_number(id) && !id.starts_with('0') && cluster.is_none_or(is_name)
        };
        let mut jobs = answer.lines().map(|line| Self(line.trim().to_owned())).filter(is_job);
        match (jobs.next(), jobs.next()) {
            (Some(job), None) => Ok(job),
            _ => Err(SlurmError::Unread {
                program: "sbatch",
                answer,
                what: "the id of a job: `squeue --me` shows whether it is submitted",
            }),
        }
    }
}

impl fmt::Display for JobId {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// The jobs of the last submission of a campaign.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Submission {
    /// The array.
    pub array: JobId,
    /// Number of tasks of the array.
    pub tasks: usize,
    /// The job that collects the database after the array; `None` if it was not submitted.
    pub collect: Option<JobId>,
}

/// The states of the last submission of a campaign.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ArrayStates {
    /// The array.
    pub array: JobId,
    /// Number of tasks in each state, in Slurm's words; tasks that Slurm no longer knows are
    /// "unknown".
    pub tasks: BTreeMap<String, usize>,
    /// The job that collects the database; `None` if it was not submitted.
    pub collect: Option<JobId>,
    /// State of this job; "unknown" if there is none, or if Slurm no longer knows it.
    pub collect_state: String,
}

/// The state of a job that Slurm does not know.
const UNKNOWN: &str = "unknown";

/// The states in which a job has ended; in all others it is waiting or active.
const ENDED: [&str; 11] = [
    "boot_fail",
    "cancelled",
    "completed",
    "deadline",
    "failed",
    "node_fail",
    "out_of_memory",
    "preempted",
    "revoked",
    "timeout",
    UNKNOWN,
];

impl ArrayStates {
    /// Whether a task or the collecting job waits or runs.
    pub fn is_active(&self) -> bool {
        let mut states = self.tasks.keys().chain([&self.collect_state]);
        states.any(|state| !has_ended(state))
    }
}

fn has_ended(state: &str) -> bool {
    ENDED.contains(&state)
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

/// The folder of scripts, logs and the record of the last submission, in the folder of a campaign.
pub fn slurm_folder(campaign_folder: &Path) -> PathBuf {
    campaign_folder.join("slurm")
}

fn record_path(campaign_folder: &Path) -> PathBuf {
    slurm_folder(campaign_folder).join("submission.json")
}

/// Writes the script to the folder of the campaign and submits it twice: as an array of `tasks`
/// tasks, and as the job that collects the database when all tasks have ended, in any state.
///
/// It is an error if the last submission has not ended, or if Slurm does not say so; if a job of an
/// unrecorded submission has not ended; and while another process submits the same campaign.
pub fn submit_array(
    campaign_folder: &Path,
    script: &str,
    tasks: usize,
) -> Result<Submission, SlurmError> {
    let folder = slurm_folder(campaign_folder);
    std::fs::create_dir_all(&folder).map_err(FileError::at(&folder))?;
    let lock = hold(&folder.join("submit.lock"))?;
    if let Some(states) = array_states(campaign_folder)?.filter(ArrayStates::is_active) {
        return Err(SlurmError::Active(states));
    }
    let path = folder.join("array.sh");
    whole_file::write(&path, script.as_bytes()).map_err(FileError::at(&path))?;
    let path = path.canonicalize().map_err(FileError::at(&path))?;
    refuse_unrecorded(&path)?;
    let sbatch = |options: &[String], argument: Option<&str>| {
        let mut command = Command::new("sbatch");
        command.arg("--parsable").args(options);
        command.arg(&path).args(argument);
        // It may outlive this process, and holds the lock until it has submitted.
        let held = lock.try_clone().map_err(FileError::at(&folder))?;
        command.stdin(held);
        JobId::try_from(output("sbatch", &mut command)?)
    };
    let array = sbatch(&[format!("--array=1-{tasks}")], None).map_err(|error| match error {
        SlurmError::Refused { message, .. } if message.contains("Invalid job array") => {
            SlurmError::TooManyTasks { tasks, message }
        }
        error => error,
    })?;
    let mut submission = Submission { array, tasks, collect: None };
    // The array is recorded before anything else can fail: otherwise it would be submitted twice.
    write_json(&record_path(campaign_folder), &submission)?;
    let after = format!("--dependency=afterany:{}", submission.array.parts().0);
    let options: Vec<_> = [after].into_iter().chain(submission.array.clusters()).collect();
    let collect = sbatch(&options, Some("collect")).map_err(|source| SlurmError::NotCollected {
        array: submission.array.clone(),
        source: Box::new(source),
    })?;
    submission.collect = Some(collect);
    write_json(&record_path(campaign_folder), &submission)?;
    Ok(submission)
}

/// Holds the lock of a submission.
fn hold(path: &Path) -> Result<File, SlurmError> {
    lock_file::try_hold(path).map_err(|error| match error.kind() {
        ErrorKind::WouldBlock => SlurmError::Busy(path.to_owned()),
        _ => FileError::at(path)(error).into(),
    })
}

/// An error if a job that has not ended runs the script: its submission was not recorded.
fn refuse_unrecorded(script: &Path) -> Result<(), SlurmError> {
    let mut squeue = Command::new("squeue");
    squeue.args(["--noheader", "--federation", "--states=all", "--format=%F|%T|%o"]);
    let queue = listed("squeue", &mut squeue)?;
    let name = script.to_string_lossy();
    let runs_script = |line: &&str| {
        let command = line.splitn(3, '|').nth(2).unwrap_or_default();
        let arguments = command.strip_prefix(&*name);
        arguments.is_some_and(|rest| rest.is_empty() || rest.starts_with(' '))
    };
    let mut jobs = queue.lines().filter(runs_script).filter_map(state);
    match jobs.find(|(_, state)| !has_ended(state)) {
        Some((job, _)) => Err(SlurmError::Unrecorded { job, script: script.to_owned() }),
        None => Ok(()),
    }
}

/// The states of the last submission of a campaign; `None` if it was never submitted.
pub fn array_states(campaign_folder: &Path) -> Result<Option<ArrayStates>, SlurmError> {
    let record = record_path(campaign_folder);
    let Some(submission) = read_json::<Submission>(&record)? else {
        return Ok(None);
    };
    let Submission { array, tasks, collect } = submission;
    let known = match known_states(&array, collect.as_ref()) {
        Ok(known) => known,
        Err(error) => return Err(SlurmError::Silent { array, record, source: Box::new(error) }),
    };
    let state = |job: &str| known.get(job).map_or(UNKNOWN, String::as_str).to_owned();
    let mut counts = BTreeMap::new();
    for task in 1..=tasks {
        *counts.entry(state(&format!("{}_{task}", array.parts().0))).or_default() += 1;
    }
    Ok(Some(ArrayStates {
        tasks: counts,
        collect_state: collect.as_ref().map_or(UNKNOWN.to_owned(), |job| state(job.parts().0)),
        array,
        collect,
    }))
}

/// The states of jobs and tasks by their ids. A state in the queue, which forgets jobs minutes
/// after their end, takes precedence over a state in the accounting, which not every site keeps,
/// and which learns of jobs late. The error of the queue if the accounting knows none of the jobs.
fn known_states(
    array: &JobId,
    collect: Option<&JobId>,
) -> Result<BTreeMap<String, String>, SlurmError> {
    let ids: Vec<&str> = [array].into_iter().chain(collect).map(|job| job.parts().0).collect();
    let jobs = [format!("--jobs={}", ids.join(","))].into_iter().chain(array.clusters());
    let jobs: Vec<_> = jobs.collect();
    let mut squeue = Command::new("squeue");
    squeue.args(["--noheader", "--array", "--states=all", "--format=%i|%T"]).args(&jobs);
    let mut sacct = Command::new("sacct");
    sacct.args(["--noheader", "--array", "--allocations", "--parsable2", "--format=JobID,State"]);
    let accounting = listed("sacct", sacct.args(&jobs)).unwrap_or_default();
    let queue = match listed("squeue", &mut squeue) {
        // The queue has forgotten all of the jobs.
        Err(SlurmError::Refused { message, .. }) if message.contains("Invalid job id") => {
            String::new()
        }
        Err(_) if accounting.lines().any(|line| state(line).is_some()) => String::new(),
        queue => queue?,
    };
    Ok([accounting, queue].iter().flat_map(|text| text.lines()).filter_map(state).collect())
}

/// The list of jobs that a program of Slurm prints; an error if none of its lines is a job.
fn listed(program: &'static str, command: &mut Command) -> Result<String, SlurmError> {
    let answer = output(program, command)?;
    if answer.trim().is_empty() || answer.lines().any(|line| state(line).is_some()) {
        return Ok(answer);
    }
    Err(SlurmError::Unread { program, answer, what: "jobs with their states" })
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
fn output(program: &'static str, command: &mut Command) -> Result<String, SlurmError> {
    verbose::note(|| format!("running {command:?}"));
    let output = command.output().map_err(|source| SlurmError::NotFound { program, source })?;
    if !output.status.success() {
        let message = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        return Err(SlurmError::Refused { program, message });
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_of_sbatch_names_one_job_by_the_grammar_or_is_quoted() {
        for (answer, written, cancel) in [
            ("105\n", "105", "scancel 105"),
            ("105;alpha\n", "105;alpha", "scancel --clusters=alpha 105"),
            ("Welcome to the cluster\n\n105;a-1\n", "105;a-1", "scancel --clusters=a-1 105"),
        ] {
            let job = JobId::try_from(answer.to_owned()).unwrap();
            assert_eq!((&*job.to_string(), &*job.cancel()), (written, cancel));
            assert_eq!(JobId::try_from(job.to_string()).unwrap(), job);
        }
        let others = [
            "",
            "\n",
            "Welcome",
            "Submitted batch job 105",
            "0",
            "-1",
            "+5",
            "1_2",
            "105;",
            ";alpha",
            "105;a;b",
            "105;a b",
            "105\n106",
            "1.5",
        ];
        for answer in others {
            let error = JobId::try_from(answer.to_owned()).unwrap_err().to_string();
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
}
