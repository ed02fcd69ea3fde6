//! The user interface of the commands: values of options, signals, exit codes.

pub mod count;
pub mod exit;
pub mod interrupt;
pub(crate) mod with_unit;

/// Number of processors of this machine.
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
