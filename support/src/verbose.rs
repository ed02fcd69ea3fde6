//! Notes on standard error of what a command does: programs that it runs, files that it reads and
//! writes, states of its solvers. They are off until [`show`] is called.

use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};

static SHOWN: AtomicBool = AtomicBool::new(false);

/// Prints every later note.
pub fn show() {
    SHOWN.store(true, Ordering::Relaxed);
}

/// Whether notes are printed.
pub fn is_shown() -> bool {
    SHOWN.load(Ordering::Relaxed)
}

/// Prints a line if notes are printed; `line` is called only then.
pub fn note(line: impl FnOnce() -> String) {
    if is_shown() {
        // A note that cannot be written must not end the work that it describes.
        let _ = writeln!(std::io::stderr(), "{}", line());
    }
}
