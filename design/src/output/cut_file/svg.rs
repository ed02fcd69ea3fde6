//! The cut lines as an SVG drawing at 1:1, one user unit per millimetre, one group per layer.

use crate::output::canvas::{Anchor, Canvas};
use crate::output::cut_file::cut_lines::{ANNOTATION, CUT, CutLines, HOLES, OUTLINE};
use crate::output::cut_file::fabrication_error::FabricationError;
use std::path::Path;

/// Margin around the sheet as a fraction of its width, with space for the note below it.
const MARGIN: f64 = 0.05;

/// Writes the cut lines; the file is replaced atomically.
pub fn write_svg(path: &Path, cuts: &CutLines) -> Result<(), FabricationError> {
    support::whole_file::write(path, svg(cuts).as_bytes()).map_err(|source| {
        FabricationError::Write {
            path: path.to_owned(),
            source,
        }
    })
}

fn svg(cuts: &CutLines) -> String {
    let outline = cuts.tool_outline();
    let along = |axis: usize| outline.iter().map(move |corner| corner[axis]);
    let low = [0, 1].map(|axis| along(axis).fold(f64::INFINITY, f64::min));
    let high = [0, 1].map(|axis| along(axis).fold(f64::NEG_INFINITY, f64::max));
    let margin = MARGIN * (high[0] - low[0]);
    let low = low.map(|value| value - margin);
    let high = high.map(|value| value + margin);

    let line = |colour| format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"0.1\"");
    let mut canvas = Canvas::new(low, high);
    canvas.open(CUT, &line("#ff0000"));
    for slit in &cuts.slits {
        canvas.line(slit.ends[0], slit.ends[1], "");
    }
    canvas.close();
    canvas.open(HOLES, &line("#0000ff"));
    for hole in &cuts.holes {
        canvas.circle(hole.centre, cuts.tool_radius(hole), "");
    }
    canvas.close();
    canvas.open(OUTLINE, &line("#000000"));
    canvas.polygon(&outline, "");
    canvas.close();
    canvas.open(ANNOTATION, "fill=\"#808080\"");
    for label in &cuts.labels {
        canvas.text(label.at, label.height, Anchor::Middle, "", &label.text);
    }
    canvas.close();
    canvas.finish(high[0] - low[0], "mm")
}
