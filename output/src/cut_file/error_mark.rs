//! The mark of files that were written although the design has errors.

use crate::cut_file::cut_drawing::{CutDrawing, Layer};
use crate::cut_file::sheet_drawing::text_height;
use crate::display::{Shape, Text};

/// What the first line says.
pub const FORCED: &str = "FORCED, NOT TO BE CUT: the design has errors";

/// Writes the errors of a design above its drawing, on a layer of their own, which is not cut. Without errors the drawing
/// stays as it is.
pub fn mark_errors(drawing: &mut CutDrawing, errors: &[String]) {
    if errors.is_empty() {
        return;
    }
    let lines: Vec<String> = std::iter::once(FORCED.to_owned())
        .chain(errors.iter().cloned())
        .collect();
    let height = text_height(drawing, &lines);
    let left = Shape::extent(drawing.cuts())[0][0];
    let top = drawing.bounds()[1][1];
    for (i, line) in lines.iter().rev().enumerate() {
        let y = top + 2.0 * height * (i + 1) as f64;
        drawing.add(
            Layer::Errors,
            Shape::Text(Text::line([left, y], height, line)),
        );
    }
}
