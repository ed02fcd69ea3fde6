//! The warnings that usvg and its reader of style sheets write to a log.

use log::{LevelFilter, Log, Metadata, Record};
use std::{cell::RefCell, sync::Once};

thread_local! {
    static WARNINGS: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
}

/// What a reading returns, and its warnings, each once.
pub(super) fn of<T>(read: impl FnOnce() -> T) -> (T, Vec<String>) {
    static INSTALLED: Once = Once::new();
    INSTALLED.call_once(|| {
        if log::set_logger(&Recorder).is_ok() {
            log::set_max_level(LevelFilter::Warn);
        }
    });
    WARNINGS.take();
    let result = read();
    let mut warnings = WARNINGS.take();
    warnings.sort();
    warnings.dedup();
    (result, warnings)
}

struct Recorder;

impl Log for Recorder {
    fn enabled(&self, metadata: &Metadata) -> bool {
        ["usvg", "simplecss"].iter().any(|name| metadata.target().starts_with(name))
    }

    fn log(&self, record: &Record) {
        if self.enabled(record.metadata()) {
            WARNINGS.with_borrow_mut(|warnings| warnings.push(record.args().to_string()));
        }
    }

    fn flush(&self) {}
}
