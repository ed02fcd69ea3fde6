//! A drawing as the target of a sheet.

use crate::objective::target::{Target, TargetError, TargetShape};
use std::path::Path;

/// Points along a drawn outline from which its area is computed.
const DRAWING_POINTS: usize = 2000;

/// Centre of the bounding box and height (mm) at which the outline of a drawing (SVG) has the given area (mm^2) and the mean of its
/// points at `centre` (mm).
pub fn place_drawing(
    file: &Path,
    centre: [f64; 2],
    area: f64,
) -> Result<([f64; 2], f64), TargetError> {
    let of_height_1 = TargetShape::Svg {
        file: file.to_owned(),
        centre: [0.0; 2],
        height: 1.0,
        rotation_deg: 0.0,
    };
    let outline = Target::sample(&of_height_1, Path::new(""), DRAWING_POINTS)?;
    let height = rounded((area / outline.area()).sqrt());
    let offset = outline.mean();
    let placed = [0, 1].map(|i| rounded(centre[i] - height * offset[i]));
    Ok((placed, height))
}

/// To six significant digits, so that a product of two short numbers is short.
pub fn rounded(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}
