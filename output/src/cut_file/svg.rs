//! SVG at 1:1, one user unit per millimetre, one group per layer.

use crate::cut_file::cut_drawing::{CutDrawing, Layer};
use crate::display::{document, group};

/// Margin around the drawing (mm).
const MARGIN: f64 = 5.0;
/// Width of the lines (mm).
const LINE: f64 = 0.1;

/// The file of a drawing, on a page around it.
pub fn svg(drawing: &CutDrawing) -> String {
    let [low, high] = drawing.bounds();
    let page = [low.map(|x| x - MARGIN), high.map(|x| x + MARGIN)];
    let used = Layer::all().filter(|layer| drawing.on(*layer).next().is_some());
    let groups = used.map(|layer| group(layer.name(), layer.rgb(), LINE, drawing.on(layer)));
    document(
        page,
        page[1][0] - page[0][0],
        "mm",
        &groups.collect::<String>(),
    )
}
