//! Cut files of a designed sheet for cutting machines, at 1:1 in mm.

mod cut_lines;
mod dxf;
mod fabrication_error;
mod svg;

pub use cut_lines::{CutLines, Hole, Label, Slit};
pub use dxf::write_dxf;
pub use fabrication_error::FabricationError;
pub use svg::write_svg;
