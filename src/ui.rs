//! The user interface of the commands: progress, files, pictures, charts, sizes, counts, exit
//! codes.

pub mod animation;
pub mod charts;
pub mod count;
pub mod exit;
pub(crate) mod input_file;
pub mod interrupt;
pub mod output_file;
pub mod picture;
pub mod progress;
pub mod run_folder;
pub mod shell_word;
pub(crate) mod with_unit;

/// Number of processors of this machine.
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
