//! Panics of a library that reads files of others: an error takes their place.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Number of calls of [`catch`] at work.
static AT_WORK: AtomicUsize = AtomicUsize::new(0);

/// The result of `work`, or the message of its panic. What `work` changes outside is not to be used
/// after a panic.
pub fn catch<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    AT_WORK.fetch_add(1, Ordering::SeqCst);
    let result = catch_unwind(AssertUnwindSafe(work));
    AT_WORK.fetch_sub(1, Ordering::SeqCst);
    result.map_err(|payload| {
        let message = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
        let message = message.or_else(|| payload.downcast_ref::<String>().cloned());
        message.unwrap_or_else(|| "unknown reason".to_owned())
    })
}

/// Whether a panic is reported by a caller of [`catch`], so that a panic hook need not print it.
/// The threads of a pool that works for this caller count as well.
pub fn is_caught() -> bool {
    AT_WORK.load(Ordering::SeqCst) > 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error_with_its_message() {
        assert_eq!(catch(|| 1), Ok(1));
        let index = std::hint::black_box(7);
        let message = catch(|| [1, 2][index]).unwrap_err();
        assert!(message.contains("out of bounds"), "{message}");
        assert_eq!(catch(|| -> i32 { panic!("why") }), Err("why".to_owned()));
    }
}
