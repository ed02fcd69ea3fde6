//! The cut pattern: outline, cut lengths and endpoints; equations (1) to (5).

pub mod coordinates;
pub mod cut_pattern;
pub mod design_vector;
pub mod grid;
