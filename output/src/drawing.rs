//! Pictures of the flat pattern, the deployed sheet and the measured sheet, as SVG.

mod chart;
mod deployed;
pub(crate) mod flat;
pub(crate) mod load_marks;
mod measured;
mod numbering;
pub mod page;

pub use deployed::{deployed, deployment_frames};
pub use flat::flat;
pub use measured::measured;
pub use numbering::numbering;
