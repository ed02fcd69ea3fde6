//! Signals. Ctrl-C: ask for a clean stop; ask again to leave at once.

use anyhow::{Context, Result};
use nix::sys::signal::{SigHandler, Signal, signal};
use std::sync::atomic::{AtomicBool, Ordering};

static LISTENING: AtomicBool = AtomicBool::new(false);
static STOP: AtomicBool = AtomicBool::new(false);

/// Ends the program when the reader of its output has gone, as in `kirigami solve | head`, where a
/// Rust program would panic.
pub fn end_quietly_when_nobody_reads() {
    // SAFETY: the default action is no handler, so nothing of ours runs in signal context.
    let _ = unsafe { signal(Signal::SIGPIPE, SigHandler::SigDfl) };
}

/// A flag that the first Ctrl-C (or SIGTERM) sets; the second ends the program.
pub fn stop_flag() -> Result<&'static AtomicBool> {
    if !LISTENING.swap(true, Ordering::Relaxed) {
        ctrlc::set_handler(|| {
            if STOP.swap(true, Ordering::Relaxed) {
                std::process::exit(130);
            }
            eprintln!("stopping; what is finished is kept (press Ctrl-C again to leave at once)");
        })
        .context("cannot listen for Ctrl-C")?;
    }
    Ok(&STOP)
}
