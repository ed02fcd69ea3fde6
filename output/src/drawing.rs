//! Pictures of the flat pattern, the deployed sheet and the measured sheet, as SVG.

mod chart;
mod deployed;
mod flat;
mod load_marks;
mod measured;
mod numbering;
pub mod page;
mod surface;

pub use deployed::{deployed, deployment_frames};
pub use flat::flat;
pub use measured::measured;
pub use numbering::numbering;
pub use surface::{Surface, View, surface};
