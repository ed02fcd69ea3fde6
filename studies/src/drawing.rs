//! Drawings of the studies: sheets under several actuations.

mod actuations;

pub use actuations::{ActuationRow, actuations};
