//! CPU time of the programs that this process started.

use anyhow::Result;
use nix::sys::resource::{UsageWho, getrusage};
use nix::sys::time::TimeValLike;

/// CPU time of all programs that this process started and that ended (s).
pub fn children_cpu_seconds() -> Result<f64> {
    // getrusage counts microseconds; /proc counts hundredths of a second, longer than the path of a small sheet takes.
    let usage = getrusage(UsageWho::RUSAGE_CHILDREN)?;
    let time = usage.user_time() + usage.system_time();
    Ok(1e-6 * time.num_microseconds() as f64)
}
