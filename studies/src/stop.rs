//! Ctrl-C between two parts of a study.

use anyhow::{Result, bail};
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
