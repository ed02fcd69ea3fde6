//! Pictures of the flat pattern and the deployed sheet, as SVG.

mod deployed;
mod flat;
pub mod page;

pub use deployed::deployed;
pub use flat::flat;
