//! Plane geometry: points, polygons, smooth extrema, distances between outlines, paths of SVG files.

pub mod chamfer;
mod near_origin;
pub mod outline_points;
pub mod plane;
pub mod polygon;
pub mod similarity;
pub mod smooth_extrema;
pub mod svg_path;
pub mod symmetric_difference;
