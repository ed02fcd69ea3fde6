//! Ctrl-C between two parts of a study.

use anyhow::{Result, ensure};
use std::sync::atomic::{AtomicBool, Ordering};

/// An error if Ctrl-C was pressed, of a study that stores nothing before its end.
pub fn refuse_stop_without_store(stop: &AtomicBool) -> Result<()> {
    ensure!(
        !stop.load(Ordering::Relaxed),
        "stopped: this study stores nothing before its end, and starts again"
    );
    Ok(())
}
