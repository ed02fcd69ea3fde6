//! Domain-independent utilities: configuration files, ranges of their keys, misspelt names, input
//! files, CSV tables, VTK files, atomic file writes, lock files, external programs, temporary
//! folders, notes of what a command does, a pool of threads, panics of libraries, tables and
//! reports for people, memory of the machine, the severity of findings.
//!
//! ```
//! use support::table::{Cell, Columns};
//!
//! let columns = Columns::new()
//!     .column("hinge", |row: &(&str, f64)| row.0)
//!     .column("error of W", |row| Cell::percent(row.1, 1));
//! let page = columns.table(&[("18 mm", 0.012)]).markdown();
//! assert_eq!(page, "| hinge | error of W |\n|---|---|\n| 18 mm | 1.2 % |\n");
//! ```

#![cfg_attr(not(test), warn(unreachable_pub))]

/// Appends a formatted line to a string.
#[macro_export]
macro_rules! add_line {
    ($text:expr, $($part:tt)*) => {{
        use std::fmt::Write;
        writeln!($text, $($part)*).expect("a string takes every line")
    }};
}

#[macro_use]
mod fault;

pub mod caught_panic;
pub mod csv_table;
pub mod document;
pub mod interpolation;
mod iterators;
pub mod key_limits;
pub mod lock_file;
#[cfg(unix)]
pub mod memory;
pub mod nearest;
#[cfg(unix)]
pub mod processes;
#[cfg(unix)]
pub mod program;
pub mod regular_file;
pub mod relative_path;
#[cfg(unix)]
pub mod scratch;
pub mod sealed_json;
pub mod severity;
pub mod statistics;
pub mod table;
pub mod text_file;
pub mod text_table;
pub mod toml_file;
pub mod vectors;
pub mod verbose;
pub mod vtk;
pub mod whole_file;
pub mod worker_pool;

pub use fault::{Fault, FileError, at, said, unread, unwritten};
pub use iterators::{Extremes, Joined};

/// A point or vector of the plane, or a point of a curve.
pub type Point = [f64; 2];
