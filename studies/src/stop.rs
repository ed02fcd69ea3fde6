//! Ctrl-C between two parts of a study.

use anyhow::{Result, bail, ensure};
use kirigami::ui::exit::Unfinished;
use std::sync::atomic::{AtomicBool, Ordering};

/// An [`Unfinished`] error if Ctrl-C was pressed. The parts that are finished must be stored, so that the same command
/// continues.
pub fn refuse_stop(stop: &AtomicBool) -> Result<()> {
    if stop.load(Ordering::Relaxed) {
        bail!(Unfinished::new(1, "study"));
    }
    Ok(())
}

/// The same for a study that stores nothing before its end.
pub fn refuse_stop_without_store(stop: &AtomicBool) -> Result<()> {
    ensure!(
        !stop.load(Ordering::Relaxed),
        "stopped: this study stores nothing before its end, and starts again"
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use kirigami::ui::exit::Exit;

    #[test]
    fn a_stopped_study_is_unfinished_and_not_failed() {
        assert!(refuse_stop(&AtomicBool::new(false)).is_ok());
        let stopped = refuse_stop(&AtomicBool::new(true));
        assert_eq!(Exit::from_result(stopped), Exit::Unfinished);
    }
}
