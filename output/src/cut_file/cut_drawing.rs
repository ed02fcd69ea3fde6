//! Shapes on layers: what every cut file draws. The shapes of a layer are cut one after the other.

use crate::display::{Colour, Shape, Style, Text};
use design::geometry::{
    polygon::{area, mean},
    region::Ring,
};
use serde::{Deserialize, Serialize};
use support::Point;

/// The tool or the purpose of a shape, in the order of cutting: what is cut later holds what is cut
/// before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Layer {
    /// The drilled ends of the slits.
    Holes,
    /// Holes for the nails and hooks of attachments.
    AttachmentHoles,
    /// The slits.
    Cut,
    /// The edge of the sheet.
    Outline,
    /// The panels of a deployed sheet, which are not cut.
    Panels,
    /// Clips, and points at which panels are held or pulled without a hole.
    Attachments,
    /// Marks outside of the outline.
    Registration,
    /// Holes that the tool cannot cut.
    Punch,
    /// Numbers, scale and cutting instructions.
    Annotation,
    /// The errors of a design whose files were forced.
    Errors,
}

/// All layers in the order of cutting: their names in DXF and SVG, red, green and blue, and the
/// AutoCAD colour index.
const LAYERS: [(Layer, &str, Colour, u8); 10] = [
    (Layer::Holes, "HOLES", [0, 0, 255], 5),
    (Layer::AttachmentHoles, "ATTACHMENT_HOLES", [0, 128, 128], 4),
    (Layer::Cut, "CUT", [255, 0, 0], 1),
    (Layer::Outline, "OUTLINE", [0, 0, 0], 7),
    (Layer::Panels, "PANELS", [0, 0, 0], 7),
    (Layer::Attachments, "ATTACHMENTS", [0, 128, 128], 4),
    (Layer::Registration, "REGISTRATION", [0, 128, 0], 3),
    (Layer::Punch, "PUNCH", [0, 128, 0], 3),
    (Layer::Annotation, "ANNOTATION", [128, 128, 128], 8),
    (Layer::Errors, "ERRORS", [255, 128, 0], 30),
];

impl Layer {
    /// All layers in the order of cutting.
    pub fn all() -> impl Iterator<Item = Self> {
        LAYERS.iter().map(|(layer, ..)| *layer)
    }

    /// The name of the layer in DXF and SVG.
    pub fn name(self) -> &'static str {
        LAYERS[self as usize].1
    }

    /// Whether the tool cuts the shapes of the layer.
    pub fn is_cut(self) -> bool {
        self <= Self::Outline
    }
}

/// A colour by which machines tell cuts from marks.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Pen {
    Blue,
    Red,
}

/// The shapes of a file in the order in which they are written and cut.
#[derive(Clone, Debug, Default)]
pub struct CutDrawing {
    /// Each shape with its layer.
    pub shapes: Vec<(Layer, Shape)>,
    /// The colours of cuts and of marks; `None`: each layer has its own.
    pub(super) pens: Option<[Pen; 2]>,
}

impl CutDrawing {
    /// Adds a shape at the end.
    pub fn add(&mut self, layer: Layer, shape: Shape) {
        self.shapes.push((layer, shape));
    }

    /// Adds a cross with arms of the given length (mm).
    pub(crate) fn add_cross(&mut self, layer: Layer, at: Point, arm: f64) {
        self.shapes.extend(Shape::cross(at, arm).map(|line| (layer, line)));
    }

    /// The shapes that the tool cuts.
    pub fn cuts(&self) -> impl Iterator<Item = &Shape> {
        let cut = self.shapes.iter().filter(|(layer, _)| layer.is_cut());
        cut.map(|(_, shape)| shape)
    }

    /// The layers that have shapes, in the order of cutting.
    pub(super) fn layers(&self) -> impl Iterator<Item = Layer> {
        Layer::all().filter(move |layer| self.on(*layer).next().is_some())
    }

    /// Red, green and blue, 0 to 255, of a layer, and the AutoCAD colour index.
    pub(super) fn pen(&self, layer: Layer) -> (Colour, u8) {
        let (_, _, colour, index) = LAYERS[layer as usize];
        let pen = self.pens.map(|pens| pens[usize::from(!layer.is_cut())]);
        match pen {
            None => (colour, index),
            Some(Pen::Blue) => ([0, 0, 255], 5),
            Some(Pen::Red) => ([255, 0, 0], 1),
        }
    }

    /// The shapes of a layer.
    pub fn on(&self, layer: Layer) -> impl Iterator<Item = &Shape> {
        let shapes = self.shapes.iter();
        shapes.filter_map(move |(on, shape)| (*on == layer).then_some(shape))
    }

    /// The lower left and the upper right corner of all shapes (mm).
    pub fn bounds(&self) -> [Point; 2] {
        Shape::extent(self.shapes.iter().map(|(_, shape)| shape))
    }

    /// The shapes layer by layer, each with the colour of its layer; lines have this width (mm).
    pub(crate) fn coloured(&self, width: f64) -> impl Iterator<Item = (Style, &Shape)> {
        let style = move |layer: Layer, shape: &Shape| match shape {
            Shape::Text(_) => Style::fill(self.pen(layer).0),
            _ => Style::stroke(self.pen(layer).0, width),
        };
        Layer::all().flat_map(move |layer| {
            let shapes = self.on(layer);
            shapes.map(move |shape| (style(layer, shape), shape))
        })
    }

    /// Shifts all shapes (mm).
    pub fn shift(&mut self, by: Point) {
        for (_, shape) in &mut self.shapes {
            shape.shift(by);
        }
    }
}

/// The panels of a deployed sheet with the given corners (mm), and their numbers, at 1:1.
pub fn deployed_panels(panels: &[Ring]) -> CutDrawing {
    let mut drawing = CutDrawing::default();
    for corners in panels {
        drawing.add(Layer::Panels, Shape::Polygon(corners.clone()));
    }
    for (k, corners) in panels.iter().enumerate() {
        let height = 0.1 * area(corners).sqrt();
        let text = Text::centred(mean(corners), height, format!("P{k}"));
        drawing.add(Layer::Annotation, Shape::Text(text));
    }
    drawing
}
