//! Pictures that people look at: the flat pattern and the deployed sheet, as SVG.

mod deployed;
mod flat;
mod page;

pub use deployed::deployed;
pub use flat::flat;
