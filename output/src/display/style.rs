//! Colours and strokes.

/// Red, green and blue.
pub type Colour = [u8; 3];

/// How a shape is drawn. A text is filled.
#[derive(Clone, Copy, Debug)]
pub struct Style {
    pub(super) fill: Option<Colour>,
    pub(super) fill_opacity: f64,
    pub(super) stroke: Option<Colour>,
    pub(super) stroke_opacity: f64,
    /// Width of the line (mm).
    pub(super) width: f64,
    /// Whether lines have round ends and corners.
    pub(super) round: bool,
    /// Lengths of a dash and of the gap after it (mm).
    pub(super) dash: Option<[f64; 2]>,
    pub(super) bold: bool,
    /// Width of the white line around a text, which is then readable over lines (mm).
    pub(super) halo: Option<f64>,
}

impl Style {
    const NOTHING: Self = Self {
        fill: None,
        fill_opacity: 1.0,
        stroke: None,
        stroke_opacity: 1.0,
        width: 0.0,
        round: false,
        dash: None,
        bold: false,
        halo: None,
    };

    /// An area or a text in one colour.
    pub fn fill(colour: Colour) -> Self {
        Self { fill: Some(colour), ..Self::NOTHING }
    }

    /// A line of the given width (mm).
    pub fn stroke(colour: Colour, width: f64) -> Self {
        Self { stroke: Some(colour), width, ..Self::NOTHING }
    }

    /// With round ends and corners of lines.
    pub fn round(mut self) -> Self {
        self.round = true;
        self
    }

    /// Dashed, with the lengths of a dash and of a gap (mm).
    pub fn dashed(mut self, dash: f64, gap: f64) -> Self {
        self.dash = Some([dash, gap]);
        self
    }

    /// A line around an area of the given colour.
    pub fn filled(mut self, colour: Colour) -> Self {
        self.fill = Some(colour);
        self
    }

    /// With the opacities of area and line, 0 to 1.
    pub fn opacity(mut self, fill: f64, stroke: f64) -> Self {
        (self.fill_opacity, self.stroke_opacity) = (fill, stroke);
        self
    }

    /// A text in bold letters.
    pub fn bold(mut self) -> Self {
        self.bold = true;
        self
    }

    /// A text with a white line of the given width around its letters (mm).
    pub fn haloed(mut self, width: f64) -> Self {
        self.halo = Some(width);
        self
    }
}
