//! Plane geometry: points, polygons, smooth extrema, distances between outlines, outlines of drawings.

pub mod bulged;
pub mod chamfer;
pub mod contour;
pub mod drawn_outline;
mod dxf_contours;
mod near_origin;
pub mod outline_points;
pub mod plane;
pub mod polygon;
pub mod similarity;
pub mod smooth_extrema;
mod svg_path;
pub mod symmetric_difference;
