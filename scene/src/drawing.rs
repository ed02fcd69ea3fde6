//! Outlines in files: drawings (SVG, DXF) and lists of points.

pub mod bulged;
pub mod contour;
mod css_geometry;
pub mod drawn_outline;
mod dxf_contours;
mod holes;
mod joined_lines;
pub mod outline_points;
mod spline;
mod svg_path;
mod svg_warnings;
mod visible_paths;
