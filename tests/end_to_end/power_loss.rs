//! What a loss of power can leave: the system calls of a run are replayed against a disk that keeps
//! only what was synced, and any part of the rest.

use crate::common::Workplace;
use std::collections::{HashMap, HashSet};
use std::process::{Command, Stdio};

/// A disk after some system calls.
#[derive(Default)]
struct Disk {
    /// Files with contents that are not synced.
    unsynced_contents: HashSet<String>,
    /// Names of files and folders that are not synced: a loss of power keeps or loses each of them.
    unsynced_names: HashSet<String>,
}

impl Disk {
    /// Applies a successful system call: its name, and the paths in its arguments.
    fn apply(&mut self, call: &str, paths: &[&str]) {
        match (call, paths) {
            ("write" | "pwrite64" | "writev", [file, ..]) => {
                self.unsynced_contents.insert((*file).to_owned());
            }
            ("fsync" | "fdatasync", [path, ..]) => {
                self.unsynced_contents.remove(*path);
                self.unsynced_names.retain(|name| folder(name) != *path);
            }
            ("mkdir" | "mkdirat", [.., path]) => {
                self.unsynced_names.insert((*path).to_owned());
            }
            ("rename" | "renameat" | "renameat2", [.., from, to]) => {
                // The disk may hold the new name.
                assert!(
                    !self.unsynced_contents.contains(*from) || !is_data(to),
                    "{to} may be left with a part of its contents"
                );
                if to.ends_with("/result.json") {
                    self.assert_whole(folder(to));
                }
                self.unsynced_names.insert((*to).to_owned());
            }
            _ => {}
        }
    }

    /// Asserts that a result which is on the disk is never without the files that it depends on.
    fn assert_whole(&self, job: &str) {
        let depends =
            |name: &&String| is_data(name) && (job.starts_with(*name) || folder(name) == job);
        let lost: Vec<_> = self.unsynced_names.iter().filter(depends).collect();
        assert!(lost.is_empty(), "{job}/result.json may be left without {lost:?}");
    }
}

/// Whether a file is read again; the files of an attempt are not.
fn is_data(path: &str) -> bool {
    !path.contains("/work-")
}

fn folder(path: &str) -> &str {
    path.rsplit_once('/').map_or("", |(folder, _)| folder)
}

/// The system calls in the output of `strace -f -y`: their names, and the paths in their arguments
/// that begin with `below`. A call that another thread interrupts stands in two lines.
fn system_calls(trace: &str, below: &str) -> Vec<(String, Vec<String>)> {
    let mut unfinished: HashMap<&str, String> = HashMap::new();
    let mut calls = Vec::new();
    for line in trace.lines() {
        let (pid, rest) = line.split_once(char::is_whitespace).unwrap();
        let rest = rest.trim_start();
        if let Some(start) = rest.strip_suffix(" <unfinished ...>") {
            unfinished.insert(pid, start.to_owned());
            continue;
        }
        let whole = match rest.strip_prefix("<... ") {
            Some(end) => {
                let end = end.split_once("resumed>").map_or("", |(_, end)| end);
                unfinished.remove(pid).unwrap_or_default() + end
            }
            None => rest.to_owned(),
        };
        let Some((call, arguments)) = whole.split_once('(') else {
            continue;
        };
        if whole.contains(" = -1 ") {
            continue;
        }
        // A path is the text of an argument, or stands in <> after the number of an open file.
        let paths = arguments.split(['"', '<', '>']);
        let paths = paths.filter(|text| text.starts_with(below)).map(str::to_owned);
        calls.push((call.to_owned(), paths.collect()));
    }
    calls
}

#[test]
fn a_loss_of_power_at_any_moment_leaves_whole_files_and_whole_jobs() {
    let work = Workplace::new();
    work.edit(
        "configs/campaigns/tiny.toml",
        &[
            ("count = 40", "count = 2"),
            ("spot_rays = 3", "spot_rays = 0"),
            ("theta_deg = [-5.0, 40.0]", "theta_deg = [2.0, 4.0]"),
            ("median_deg = 20.0", "median_deg = 3.0"),
        ],
    );
    let folder = work.path("runs");
    let below = folder.parent().unwrap().to_str().unwrap();
    let run = work
        .program(&format!("campaign run configs/campaigns/tiny.toml --folder {below}/runs/tiny"));
    let calls =
        "trace=write,pwrite64,writev,fsync,fdatasync,rename,renameat,renameat2,mkdir,mkdirat";
    let mut traced = Command::new("strace");
    // `-s 0` omits what is written, but no path.
    traced
        .args(["-f", "-y", "-qqq", "--seccomp-bpf", "-s", "0", "-o", "trace", "-e", calls])
        .arg(run.get_program())
        .args(run.get_args())
        .current_dir(work.path(""))
        .stdout(Stdio::null());
    assert!(traced.status().unwrap().success());
    let trace = work.read("trace");

    let mut disk = Disk::default();
    let mut results = 0;
    for (call, paths) in system_calls(&trace, below) {
        let paths: Vec<&str> = paths.iter().map(String::as_str).collect();
        let named = |end: &str| paths.last().is_some_and(|path| path.ends_with(end));
        results += usize::from(call.starts_with("rename") && named("/result.json"));
        disk.apply(&call, &paths);
    }
    assert_eq!(results, 2, "{trace}");
    // What the run has reported is on the disk.
    let lost: Vec<_> = disk.unsynced_names.iter().filter(|name| is_data(name)).collect();
    assert!(lost.is_empty(), "{lost:?}");
}
