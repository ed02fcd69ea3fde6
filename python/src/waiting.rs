//! Calls without the GIL, and Ctrl-C during those that take long.

use pyo3::{exceptions::PyRuntimeError, prelude::*};
use std::{
    panic::resume_unwind,
    sync::{
        OnceLock,
        atomic::{AtomicBool, Ordering},
        mpsc::{RecvTimeoutError, channel},
    },
    time::Duration,
};

/// How often Python is asked for signals.
const POLL: Duration = Duration::from_millis(50);

/// The result of `work`, without the GIL; an error in a fork of the process that began to compute,
/// whose threads are missing here.
pub(crate) fn unlocked<T: Send>(work: impl FnOnce() -> T + Send) -> PyResult<T> {
    static OWNER: OnceLock<u32> = OnceLock::new();
    if *OWNER.get_or_init(std::process::id) != std::process::id() {
        return Err(PyRuntimeError::new_err(
            "this process is a fork of one that has used kirigami, without its threads: start processes by \
             multiprocessing.get_context(\"spawn\")",
        ));
    }
    Ok(Python::attach(|py| py.detach(work)))
}

/// The result of `work`, which ends early when `stop` becomes true: at Ctrl-C, which is then
/// raised.
pub(crate) fn while_polling<T: Send>(
    stop: &AtomicBool,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    unlocked(|| {
        std::thread::scope(|scope| {
            let (done, finished) = channel();
            let worker = scope.spawn(move || {
                let result = work();
                // The receiver waits until the end of the scope.
                let _ = done.send(());
                result
            });
            let mut interrupt = None;
            while finished.recv_timeout(POLL) == Err(RecvTimeoutError::Timeout) {
                if let Err(signal) = Python::attach(|py| py.check_signals()) {
                    stop.store(true, Ordering::Relaxed);
                    interrupt.get_or_insert(signal);
                }
            }
            let result = worker.join().unwrap_or_else(|panic| resume_unwind(panic));
            interrupt.map_or(Ok(result), Err)
        })
    })?
}
