//! Processes of this machine, from /proc: their times and memory, and those that were started for a
//! folder.

use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::time::Duration;

/// Environment variable with the folder that a program was started for. Its descendants inherit it,
/// also those that leave its process group and its session.
pub(crate) const FOLDER: &str = "KIRIGAMI_WORK_FOLDER";

/// Kills all processes that were started for `folder` and their descendants.
///
/// A process may be forked while the list is read, so the list is read until no process is left, or
/// a few times: a process that waits for a disk dies later.
pub fn kill_all_of(folder: &Path) {
    for _ in 0..5 {
        let processes = started_for(folder);
        if processes.is_empty() {
            return;
        }
        for process in processes {
            // An error means that the process no longer exists.
            let _ = kill(process, Signal::SIGKILL);
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Whether a process with this number runs on this host.
pub fn is_running(process: u32) -> bool {
    Path::new("/proc").join(process.to_string()).exists()
}

/// The processes whose environment names `folder`. The processes of other users cannot be read and
/// are not ours.
fn started_for(folder: &Path) -> Vec<Pid> {
    let mark = [FOLDER.as_bytes(), b"=", folder.as_os_str().as_bytes()].concat();
    let Ok(processes) = std::fs::read_dir("/proc") else {
        return Vec::new();
    };
    let marked = |process: std::fs::DirEntry| {
        let pid = process.file_name().to_str()?.parse().ok()?;
        let environment = std::fs::read(process.path().join("environ")).ok()?;
        let mut variables = environment.split(|byte| *byte == 0);
        variables.any(|variable| variable == mark).then(|| Pid::from_raw(pid))
    };
    processes.flatten().filter_map(marked).collect()
}

/// User and system seconds of all threads of a process, in hundredths, from /proc; `None` if it was
/// reaped, or if the operating system does not report them.
pub fn cpu_seconds(pid: u32) -> Option<f64> {
    /// Clock ticks per second in /proc, the same on every Linux system.
    const USER_HZ: f64 = 100.0;
    let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    // The second field, a name in parentheses, may contain any characters.
    let fields: Vec<_> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks = |i: usize| fields.get(i)?.parse::<f64>().ok();
    Some((ticks(11)? + ticks(12)?) / USER_HZ)
}

/// Maximum resident memory of a running process until now (MiB), from /proc.
pub(crate) fn memory_mib(pid: u32) -> Option<f64> {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib / 1024.0)
}
