//! A child process in a process group and an environment of its own, none of whose processes
//! outlives it.

use crate::processes::{FOLDER, cpu_seconds, kill_all_of};
use nix::sys::resource::{Resource, getrlimit, setrlimit};
use nix::sys::signal::{Signal, killpg};
use nix::sys::wait::{Id, WaitPidFlag, WaitStatus, waitid};
use nix::unistd::Pid;
use std::fs::File;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Maximum size of a file that a program writes (MiB). Results are read into memory as a whole.
pub(super) const MAX_FILE_MIB: u64 = 1024;
/// Time between SIGTERM and SIGKILL.
pub(super) const GRACE: Duration = Duration::from_secs(2);
/// Maximum polling interval of a running program.
pub(super) const POLL: Duration = Duration::from_millis(20);

/// A child process that leads its own process group; dropping this value kills the group and every
/// other process that the child started.
pub(super) struct Group {
    child: Child,
    /// The folder that it runs in.
    folder: PathBuf,
}

impl Group {
    /// Starts a program in `folder`, with its output in `log`, after killing what an earlier run
    /// left there.
    pub(super) fn spawn(
        program: &Path,
        arguments: &[&str],
        folder: &Path,
        log: &Path,
    ) -> std::io::Result<Self> {
        let folder = std::path::absolute(folder)?;
        kill_all_of(&folder);
        let output = File::create(log)?;
        let mut command = Command::new(program);
        command
            .args(arguments)
            .current_dir(&folder)
            .stdin(Stdio::null())
            .stdout(output.try_clone()?)
            .stderr(output)
            .process_group(0);
        // The user's environment and home must not decide a result: ccx reads CCX_NPROC_*, gmsh
        // reads ~/.gmshrc.
        command.env_clear().env("HOME", &folder).env("LC_ALL", "C");
        command.env(FOLDER, &folder);
        for variable in ["PATH", "LD_LIBRARY_PATH", "TMPDIR"] {
            if let Some(value) = std::env::var_os(variable) {
                command.env(variable, value);
            }
        }
        // One process runs per core: a second thread gives no speed-up at these problem sizes.
        for variable in [
            "OMP_NUM_THREADS",
            "OPENBLAS_NUM_THREADS",
            "CCX_NPROC_EQUATION_SOLVER",
            "CCX_NPROC_RESULTS",
            "CCX_NPROC_STIFFNESS",
        ] {
            command.env(variable, "1");
        }
        #[cfg(target_os = "linux")]
        // SAFETY: between fork and exec the closure makes only three system calls, prctl, getrlimit
        // and setrlimit, which are async-signal-safe, and does not allocate.
        unsafe {
            command.pre_exec(|| {
                // Only root may raise the limit that it was started with.
                let (_, most) = getrlimit(Resource::RLIMIT_FSIZE)?;
                let bytes = most.min(MAX_FILE_MIB << 20);
                setrlimit(Resource::RLIMIT_FSIZE, bytes, bytes)?;
                Ok(nix::sys::prctl::set_pdeathsig(Signal::SIGKILL)?)
            });
        }
        let child = command.spawn()?;
        Ok(Self { child, folder })
    }

    /// The process number of the leader.
    pub(super) fn id(&self) -> u32 {
        self.child.id()
    }

    /// Waits for the leader and reaps it.
    pub(super) fn wait(&mut self) -> std::io::Result<ExitStatus> {
        self.child.wait()
    }

    fn pid(&self) -> Pid {
        Pid::from_raw(self.child.id() as i32)
    }

    /// Whether the leader has exited; it stays a zombie, so its CPU time can still be read.
    pub(super) fn has_ended(&self) -> bool {
        !matches!(self.look(WaitPidFlag::WNOHANG), Ok(WaitStatus::StillAlive))
    }

    /// Waits for the leader, or polls it with WNOHANG, without reaping it.
    fn look(&self, how: WaitPidFlag) -> nix::Result<WaitStatus> {
        let flags = WaitPidFlag::WEXITED | WaitPidFlag::WNOWAIT | how;
        waitid(Id::Pid(self.pid()), flags)
    }

    /// User and system seconds of the leader, which has exited or is about to exit.
    pub(super) fn cpu_seconds(&self) -> Option<f64> {
        self.look(WaitPidFlag::empty()).ok()?;
        cpu_seconds(self.child.id())
    }

    /// Sends SIGTERM, waits up to the grace period, then sends SIGKILL.
    pub(super) fn end(&self) {
        let deadline = Instant::now() + GRACE;
        // An error means that the group no longer exists, which is the desired state.
        let _ = killpg(self.pid(), Signal::SIGTERM);
        while !self.has_ended() && Instant::now() < deadline {
            std::thread::sleep(POLL);
        }
        let _ = killpg(self.pid(), Signal::SIGKILL);
    }
}

impl Drop for Group {
    /// Kills the group and reaps its leader, if the leader is still running, and kills what it left
    /// running.
    fn drop(&mut self) {
        if let Ok(None) = self.child.try_wait() {
            let _ = killpg(self.pid(), Signal::SIGKILL);
            let _ = self.child.wait();
        }
        kill_all_of(&self.folder);
    }
}
