//! Pictures that people look at: the flat pattern and the deployed sheet, as SVG.

mod actuations;
mod deployed;
mod flat;
mod page;

pub use actuations::{ActuationRow, actuations};
pub use deployed::deployed;
pub use flat::flat;
