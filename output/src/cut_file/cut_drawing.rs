//! Shapes on layers: what every cut file draws. The shapes of a layer are cut one after the other.

use crate::display::{Colour, Shape, Style};

/// The tool or the purpose of a shape, in the order of cutting: what is cut later holds what is cut before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Layer {
    /// The drilled ends of the slits.
    Holes,
    /// The slits.
    Cut,
    /// The seams between two parts of a sheet.
    Joint,
    /// The edge of the sheet.
    Outline,
    /// The panels of a deployed sheet, which are not cut.
    Panels,
    /// Marks outside of the outline.
    Registration,
    /// Numbers, scale and cutting instructions.
    Annotation,
    /// The errors of a design whose files were forced.
    Errors,
}

impl Layer {
    /// All layers in the order of cutting.
    pub const ALL: [Self; 8] = [
        Self::Holes,
        Self::Cut,
        Self::Joint,
        Self::Outline,
        Self::Panels,
        Self::Registration,
        Self::Annotation,
        Self::Errors,
    ];

    /// The name of the layer in DXF and SVG.
    pub fn name(self) -> &'static str {
        match self {
            Self::Holes => "HOLES",
            Self::Cut => "CUT",
            Self::Joint => "JOINT",
            Self::Outline => "OUTLINE",
            Self::Panels => "PANELS",
            Self::Registration => "REGISTRATION",
            Self::Annotation => "ANNOTATION",
            Self::Errors => "ERRORS",
        }
    }

    /// Whether the tool cuts the shapes of the layer.
    pub fn is_cut(self) -> bool {
        self <= Self::Outline
    }

    /// Red, green and blue, 0 to 255.
    pub(super) fn rgb(self) -> Colour {
        match self {
            Self::Holes => [0, 0, 255],
            Self::Cut => [255, 0, 0],
            Self::Joint => [255, 0, 255],
            Self::Outline | Self::Panels => [0, 0, 0],
            Self::Registration => [0, 128, 0],
            Self::Annotation => [128, 128, 128],
            Self::Errors => [255, 128, 0],
        }
    }
}

/// The shapes of a file in the order in which they are written and cut.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CutDrawing {
    /// Each shape with its layer.
    pub shapes: Vec<(Layer, Shape)>,
}

impl CutDrawing {
    /// Adds a shape at the end.
    pub fn add(&mut self, layer: Layer, shape: Shape) {
        self.shapes.push((layer, shape));
    }

    /// The shapes that the tool cuts.
    pub fn cuts(&self) -> impl Iterator<Item = &Shape> {
        let cut = self.shapes.iter().filter(|(layer, _)| layer.is_cut());
        cut.map(|(_, shape)| shape)
    }

    /// The shapes of a layer.
    pub fn on(&self, layer: Layer) -> impl Iterator<Item = &Shape> {
        let shapes = self.shapes.iter();
        shapes.filter_map(move |(on, shape)| (*on == layer).then_some(shape))
    }

    /// The lower left and the upper right corner of all shapes (mm).
    pub fn bounds(&self) -> [[f64; 2]; 2] {
        Shape::extent(self.shapes.iter().map(|(_, shape)| shape))
    }

    /// The shapes layer by layer, each with the colour of its layer; lines have this width (mm).
    pub(crate) fn coloured(&self, width: f64) -> impl Iterator<Item = (Style, &Shape)> {
        let style = move |layer: Layer, shape: &Shape| match shape {
            Shape::Text(_) => Style::fill(layer.rgb()),
            _ => Style::stroke(layer.rgb(), width),
        };
        Layer::ALL.into_iter().flat_map(move |layer| {
            let shapes = self.on(layer);
            shapes.map(move |shape| (style(layer, shape), shape))
        })
    }

    /// Shifts all shapes (mm).
    pub fn shift(&mut self, by: [f64; 2]) {
        for (_, shape) in &mut self.shapes {
            shape.shift(by);
        }
    }
}
