//! SVG at 1:1, one user unit per millimetre from the upper left corner of the page, one group per
//! layer.

use crate::{
    cut_file::cut_drawing::CutDrawing,
    display::{document, group},
};
use design::geometry::polygon::size;

/// Margin around the drawing (mm).
const MARGIN: f64 = 5.0;
/// Width of the lines (mm).
const LINE: f64 = 0.1;

/// The file of a drawing, on a page around it.
pub fn svg(drawing: &CutDrawing) -> String {
    let [low, high] = drawing.bounds();
    let [width, height] = size([low, high]).map(|side| side + 2.0 * MARGIN);
    // Some readers take the corner of the view for the origin.
    let mut moved = drawing.clone();
    moved.shift([MARGIN - low[0], -MARGIN - high[1]]);
    let groups = moved.layers().map(|layer| {
        let (colour, _) = moved.pen(layer);
        group(layer.name(), colour, LINE, moved.on(layer))
    });
    let groups: String = groups.collect();
    document([[0.0, -height], [width, 0.0]], width, "mm", &groups)
}
