//! A silhouette becomes a sheet: the place and the size of the target, the outline of the sheet,
//! its cuts and its pulls, which the kinematics decide before any force is computed.

pub mod opening;
pub mod placement;
pub mod pulls;
pub mod scene;
pub mod silhouette;
