//! Drawings of the studies: sheets under several actuations, sheets side by side.

mod actuations;
mod side_by_side;

pub use actuations::{ActuationRow, actuations};
pub use side_by_side::{Column, side_by_side};
