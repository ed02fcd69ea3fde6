//! Finds processes that are still running.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Working folders below `folder` of processes that still run; waits up to 5 s for them to exit
/// after SIGKILL.
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
