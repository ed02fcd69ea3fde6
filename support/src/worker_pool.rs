//! A pool of threads that work through numbered items, and report to the thread that started them.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::Duration;

/// Interval at which the stop flag is checked.
const GLANCE: Duration = Duration::from_millis(100);

/// The operating system started no thread.
#[derive(Debug, thiserror::Error)]
#[error(
    "the operating system starts no further thread ({0}): end other programs, or raise the limits of processes and memory \
     (ulimit -u, ulimit -v)"
)]
pub struct NoThread(pub std::io::Error);

/// The sending side of a worker.
pub struct Reports<'a, M> {
    sender: mpsc::Sender<M>,
    halt: &'a AtomicBool,
}

impl<M> Reports<'_, M> {
    /// Hands a message to the thread that started the pool.
    pub fn send(&self, message: M) {
        // The receiver is gone only if it panicked.
        if self.sender.send(message).is_err() {
            self.halt.store(true, Ordering::Relaxed);
        }
    }

    /// Set when the work is to end: the item in progress too, as soon as it can.
    pub fn halt(&self) -> &AtomicBool {
        self.halt
    }
}

/// Calls `work` for the items 0 to `count` - 1, in this order, on at most `workers` threads, and
/// `note` for every message on this thread. Fewer threads do the same work if the operating system
/// does not start all of them.
///
/// Once `stop` is true, or `note` has returned an error, no item is started and [`Reports::halt`]
/// is set. Returns the first error of `note`, after all threads have ended.
pub fn work_through<M: Send, E: From<NoThread>>(
    count: usize,
    workers: usize,
    stop: &AtomicBool,
    work: &(dyn Fn(usize, &Reports<M>) + Sync),
    note: &mut dyn FnMut(M) -> Result<(), E>,
) -> Result<(), E> {
    let (next, halt) = (AtomicUsize::new(0), AtomicBool::new(false));
    let (sender, receiver) = mpsc::channel();
    if cfg!(target_family = "wasm") {
        // No threads: each item, then its messages.
        let reports = Reports { sender, halt: &halt };
        let mut outcome = Ok(());
        for item in 0..count {
            work(item, &reports);
            outcome =
                receiver.try_iter().fold(outcome, |outcome, message| outcome.and(note(message)));
            if outcome.is_err() || stop.load(Ordering::Relaxed) {
                break;
            }
        }
        return outcome;
    }
    thread::scope(|scope| {
        for started in 0..workers.clamp(1, count.max(1)) {
            let (sender, halt) = (sender.clone(), &halt);
            let reports = Reports { sender, halt };
            let next = &next;
            let worker = move || {
                while !halt.load(Ordering::Relaxed) {
                    match next.fetch_add(1, Ordering::Relaxed) {
                        item if item < count => work(item, &reports),
                        _ => break,
                    }
                }
            };
            match thread::Builder::new().spawn_scoped(scope, worker) {
                Err(error) if started == 0 => return Err(NoThread(error).into()),
                Err(_) => break,
                Ok(_) => {}
            }
        }
        drop(sender);
        receive(&receiver, stop, &halt, note)
    })
}

/// Notes the messages until every worker has ended; halts the workers on an error or on request.
fn receive<M, E>(
    receiver: &Receiver<M>,
    stop: &AtomicBool,
    halt: &AtomicBool,
    note: &mut dyn FnMut(M) -> Result<(), E>,
) -> Result<(), E> {
    let mut outcome = Ok(());
    loop {
        match receiver.recv_timeout(GLANCE) {
            Ok(message) => {
                let noted = note(message);
                outcome = outcome.and(noted);
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return outcome,
        }
        if outcome.is_err() || stop.load(Ordering::Relaxed) {
            halt.store(true, Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, PartialEq)]
    enum Fault {
        NoThread,
        Item(usize),
    }

    impl From<NoThread> for Fault {
        fn from(_: NoThread) -> Self {
            Self::NoThread
        }
    }

    #[test]
    fn every_item_is_worked_on_once() {
        let mut seen = vec![0; 50];
        let work = |item: usize, reports: &Reports<usize>| reports.send(item);
        work_through(50, 4, &AtomicBool::new(false), &work, &mut |item| {
            seen[item] += 1;
            Ok::<_, Fault>(())
        })
        .unwrap();
        assert_eq!(seen, [1; 50]);
    }

    #[test]
    fn an_error_ends_the_work_and_is_the_first() {
        let started = AtomicUsize::new(0);
        let work = |item: usize, reports: &Reports<usize>| {
            started.fetch_add(1, Ordering::Relaxed);
            reports.send(item);
            while item > 2 && !reports.halt().load(Ordering::Relaxed) {
                thread::sleep(Duration::from_millis(1));
            }
        };
        let mut fails = |item| (item != 2).then_some(()).ok_or(Fault::Item(item));
        let ended = work_through(1000, 2, &AtomicBool::new(false), &work, &mut fails);
        assert_eq!(ended, Err(Fault::Item(2)));
        assert!(started.into_inner() < 10);
    }

    #[test]
    fn a_stop_halts_the_items_in_progress() {
        let stop = AtomicBool::new(false);
        let work = |item: usize, reports: &Reports<usize>| {
            reports.send(item);
            while !reports.halt().load(Ordering::Relaxed) {
                thread::sleep(Duration::from_millis(1));
            }
        };
        let mut seen = Vec::new();
        work_through(10, 2, &stop, &work, &mut |item| {
            seen.push(item);
            stop.store(true, Ordering::Relaxed);
            Ok::<_, Fault>(())
        })
        .unwrap();
        assert!(seen.len() <= 2, "{seen:?}");
    }

    #[test]
    fn no_item_is_no_work() {
        let work = |_: usize, _: &Reports<()>| unreachable!();
        let mut sink = |()| Ok::<_, Fault>(());
        let ended = work_through(0, 4, &AtomicBool::new(false), &work, &mut sink);
        assert_eq!(ended, Ok(()));
    }
}
