//! A drawing becomes a sheet: an even pattern laid over it, and the panels that it keeps, which the
//! kinematics decide before any force is computed.

mod even_pattern;
pub mod even_sheet;
pub mod fasteners;
mod lost;
pub mod opening;
mod raster;
pub mod scene;
pub mod trimmed;
