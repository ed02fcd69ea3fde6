//! Shapes on layers: what every cut file draws. The shapes of a layer are cut one after the other.

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
    pub(super) fn rgb(self) -> [u8; 3] {
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

/// One shape; lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A straight line, from its first to its second end.
    Line([[f64; 2]; 2]),
    /// A circle.
    Circle {
        /// Its centre.
        centre: [f64; 2],
        /// Its radius.
        radius: f64,
    },
    /// A closed polygon.
    Polygon(Vec<[f64; 2]>),
    /// A text of one line.
    Text(Text),
}

/// A horizontal text.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// The middle of the text, or the left end of its baseline (mm).
    pub at: [f64; 2],
    /// Whether `at` is the middle of the text.
    pub centred: bool,
    /// Height of the capitals (mm).
    pub height: f64,
    /// The text, one line.
    pub text: String,
}

/// Width of a character relative to the height of the capitals: an upper bound for digits of DejaVu Sans, of Helvetica
/// and of the stroke font of DXF readers.
const CHARACTER: f64 = 0.9;

impl Text {
    /// Width and height of the text (mm), an upper bound for texts of digits.
    pub fn size(&self) -> [f64; 2] {
        [
            CHARACTER * self.height * self.text.chars().count() as f64,
            self.height,
        ]
    }

    /// The lower left and the upper right corner of the text (mm).
    pub fn corners(&self) -> [[f64; 2]; 2] {
        let ([x, y], [width, height]) = (self.at, self.size());
        match self.centred {
            true => [
                [x - 0.5 * width, y - 0.5 * height],
                [x + 0.5 * width, y + 0.5 * height],
            ],
            false => [self.at, [x + width, y + height]],
        }
    }
}

impl Shape {
    /// Where the tool begins and ends. A hole begins and ends at its centre, where the tool pierces the material.
    pub fn ends(&self) -> [[f64; 2]; 2] {
        match self {
            Self::Line(ends) => *ends,
            Self::Circle { centre, .. } => [*centre; 2],
            Self::Polygon(corners) => [corners.first().copied().unwrap_or_default(); 2],
            Self::Text(text) => [text.at; 2],
        }
    }

    /// Length of the line (mm); zero for a text.
    pub fn length(&self) -> f64 {
        let around = |corners: &[[f64; 2]]| {
            let following = corners.iter().cycle().skip(1);
            std::iter::zip(corners, following)
                .map(|(p, q)| distance(*p, *q))
                .sum()
        };
        match self {
            Self::Line([from, to]) => distance(*from, *to),
            Self::Circle { radius, .. } => std::f64::consts::TAU * radius,
            Self::Polygon(corners) => around(corners),
            Self::Text(_) => 0.0,
        }
    }

    /// Points whose bounding box is that of the shape.
    fn extremes(&self) -> Vec<[f64; 2]> {
        match self {
            Self::Line(ends) => ends.to_vec(),
            Self::Circle { centre, radius } => {
                [-radius, *radius].map(|r| centre.map(|x| x + r)).to_vec()
            }
            Self::Polygon(corners) => corners.clone(),
            Self::Text(text) => text.corners().to_vec(),
        }
    }

    fn shift(&mut self, by: [f64; 2]) {
        let shift = |point: &mut [f64; 2]| *point = [point[0] + by[0], point[1] + by[1]];
        match self {
            Self::Line(ends) => ends.iter_mut().for_each(shift),
            Self::Circle { centre, .. } => shift(centre),
            Self::Polygon(corners) => corners.iter_mut().for_each(shift),
            Self::Text(text) => shift(&mut text.at),
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

    /// The lower left and the upper right corner of the bounding box of some shapes (mm).
    pub fn extent<'a>(shapes: impl Iterator<Item = &'a Shape>) -> [[f64; 2]; 2] {
        let nothing = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        shapes
            .flat_map(Shape::extremes)
            .fold(nothing, |[low, high], [x, y]| {
                [
                    [low[0].min(x), low[1].min(y)],
                    [high[0].max(x), high[1].max(y)],
                ]
            })
    }

    /// The lower left and the upper right corner of all shapes (mm).
    pub fn bounds(&self) -> [[f64; 2]; 2] {
        Self::extent(self.shapes.iter().map(|(_, shape)| shape))
    }

    /// Shifts all shapes (mm).
    pub fn shift(&mut self, by: [f64; 2]) {
        for (_, shape) in &mut self.shapes {
            shape.shift(by);
        }
    }
}

/// Distance of two points (mm).
pub(super) fn distance(p: [f64; 2], q: [f64; 2]) -> f64 {
    f64::hypot(q[0] - p[0], q[1] - p[1])
}
