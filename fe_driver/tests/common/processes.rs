//! What is left running; the tests of the command line look with the same eyes.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Working folders under `folder` of processes that still run, given a moment to die of SIGKILL.
pub fn left_running(folder: &Path) -> Vec<PathBuf> {
    let running = || -> Vec<PathBuf> {
        let processes = std::fs::read_dir("/proc").unwrap().flatten();
        processes
            .filter_map(|process| std::fs::read_link(process.path().join("cwd")).ok())
            .filter(|cwd| cwd.starts_with(folder))
            .collect()
    };
    let deadline = Instant::now() + Duration::from_secs(5);
    while !running().is_empty() && Instant::now() < deadline {
        std::thread::sleep(Duration::from_millis(20));
    }
    running()
}
