//! The panels of the deployed sheet, at 1:1.

use crate::cut_file::cut_drawing::{CutDrawing, Layer};
use crate::display::{Shape, Text};
use design::geometry::polygon::{area, mean};

/// The panels with the given corners (mm), and their numbers.
pub fn deployed_panels(panels: &[[[f64; 2]; 4]]) -> CutDrawing {
    let mut drawing = CutDrawing::default();
    for corners in panels {
        drawing.add(Layer::Panels, Shape::Polygon(corners.to_vec()));
    }
    for (k, corners) in panels.iter().enumerate() {
        let height = 0.1 * area(corners).sqrt();
        let text = Text::centred(mean(corners), height, format!("P{k}"));
        drawing.add(Layer::Annotation, Shape::Text(text));
    }
    drawing
}
