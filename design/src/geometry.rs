//! Plane geometry: points, polygons, smooth extrema, distances between outlines.

pub mod chamfer;
pub mod plane;
pub mod polygon;
pub mod region;
pub mod similarity;
pub mod smooth_extrema;
pub mod symmetric_difference;
