//! Signals. The first Ctrl-C requests a clean stop; the second ends the program at once.

use anyhow::Result;
use std::sync::atomic::AtomicBool;

#[cfg(unix)]
static LISTENING: AtomicBool = AtomicBool::new(false);
static STOP: AtomicBool = AtomicBool::new(false);

#[cfg(unix)]
/// Ends the program without a message when the reader of its output is gone, as in `kirigami solve |
/// head`, where a Rust program would panic by default.
pub fn end_quietly_when_nobody_reads() {
    use nix::sys::signal::{SigHandler, Signal, signal};
    // SAFETY: SIG_DFL installs no handler, so no code of this program runs in signal context.
    let _ = unsafe { signal(Signal::SIGPIPE, SigHandler::SigDfl) };
}

#[cfg(unix)]
/// A flag that the first Ctrl-C (or SIGTERM) sets; the second ends the program.
pub fn stop_flag() -> Result<&'static AtomicBool> {
    use anyhow::Context;
    use std::sync::atomic::Ordering;
    use support::worker_pool::NoThread;
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

/// A page in a browser gets no signals.
#[cfg(not(unix))]
pub fn stop_flag() -> Result<&'static AtomicBool> {
    Ok(&STOP)
}
