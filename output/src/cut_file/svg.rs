//! SVG at 1:1, one user unit per millimetre, one group per layer.

use crate::canvas::{Anchor, Canvas};
use crate::cut_file::cut_drawing::{CutDrawing, Layer, Shape, Text};
use crate::cut_file::fabrication_error::FabricationError;
use std::path::Path;

/// Margin around the drawing (mm).
const MARGIN: f64 = 5.0;
/// Height of the capitals of DejaVu Sans, relative to the size of the font.
const CAPITALS: f64 = 0.729;

/// Writes a drawing; the file is replaced atomically.
pub fn write_svg(path: &Path, drawing: &CutDrawing) -> Result<(), FabricationError> {
    support::whole_file::write(path, svg(drawing).as_bytes()).map_err(|source| {
        FabricationError::Write {
            path: path.to_owned(),
            source,
        }
    })
}

fn svg(drawing: &CutDrawing) -> String {
    let [low, high] = drawing.bounds();
    let (low, high) = (low.map(|x| x - MARGIN), high.map(|x| x + MARGIN));
    let mut canvas = Canvas::new(low, high);
    for layer in Layer::ALL {
        let mut shapes = drawing.on(layer).peekable();
        if shapes.peek().is_none() {
            continue;
        }
        let [r, g, b] = layer.rgb();
        let colour = format!("#{r:02x}{g:02x}{b:02x}");
        let style = format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"0.1\"");
        canvas.open(layer.name(), &style);
        for shape in shapes {
            match shape {
                Shape::Line([from, to]) => canvas.line(*from, *to, ""),
                Shape::Circle { centre, radius } => canvas.circle(*centre, *radius, ""),
                Shape::Polygon(corners) => canvas.polygon(corners, ""),
                Shape::Text(text) => write_text(&mut canvas, text, &colour),
            }
        }
        canvas.close();
    }
    canvas.finish(high[0] - low[0], "mm")
}

fn write_text(canvas: &mut Canvas, text: &Text, colour: &str) {
    let [x, y] = text.at;
    let (at, anchor) = match text.centred {
        true => ([x, y - 0.5 * text.height], Anchor::Middle),
        false => (text.at, Anchor::Start),
    };
    let style = format!("fill=\"{colour}\" stroke=\"none\"");
    canvas.text(at, text.height / CAPITALS, anchor, &style, &text.text);
}
