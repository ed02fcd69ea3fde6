//! Signals. The first Ctrl-C requests a clean stop; the second ends the program at once.

use anyhow::{Context, Result};
use std::sync::atomic::{AtomicBool, Ordering};
use support::worker_pool::NoThread;

static LISTENING: AtomicBool = AtomicBool::new(false);
static STOP: AtomicBool = AtomicBool::new(false);

/// Ends the program without a message when the reader of its output is gone, as in `kirigami solve |
/// head`, where a Rust program would panic by default.
pub fn end_quietly_when_nobody_reads() {
    use nix::sys::signal::{SigHandler, Signal, signal};
    // SAFETY: SIG_DFL installs no handler, so no code of this program runs in signal context.
    let _ = unsafe { signal(Signal::SIGPIPE, SigHandler::SigDfl) };
}

/// A flag that the first Ctrl-C (or SIGTERM) sets; the second ends the program.
pub fn stop_flag() -> Result<&'static AtomicBool> {
    if !LISTENING.swap(true, Ordering::Relaxed) {
        ctrlc::set_handler(|| {
            if STOP.swap(true, Ordering::Relaxed) {
                std::process::exit(130);
            }
            eprintln!("stopping; finished work is kept (press Ctrl-C again to quit at once)");
        })
        .map_err(|error| match error {
            ctrlc::Error::System(source) => anyhow::Error::from(NoThread(source)),
            other => other.into(),
        })
        .context("cannot listen for Ctrl-C")?;
    }
    Ok(&STOP)
}
