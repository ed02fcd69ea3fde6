//! Pictures that people look at: the flat pattern and the deployed sheet, as SVG.

mod actuations;
mod deployed;
mod flat;
mod page;
mod side_by_side;

pub use actuations::{ActuationRow, actuations};
pub use deployed::deployed;
pub use flat::flat;
pub use side_by_side::{Column, side_by_side};
