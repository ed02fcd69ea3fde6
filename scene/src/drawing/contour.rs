//! A line in a drawing, and what makes it an outline.

use design::geometry::polygon;

/// Points closer than this fraction of the largest coordinate are merged: usvg rounds to f32.
pub(super) const WELD: f64 = 1e-6;
/// Largest coordinate over the size of an outline from which its rounding shows.
const TOO_FAR: f64 = 1000.0;
/// Maximum number of points of an outline, 3000 curves: the worst one of them is checked for
/// crossings in seconds.
pub(super) const MOST_POINTS: usize = 100_000;
/// Number of contours that a message lists.
pub(super) const LISTED: usize = 5;

/// Why a file has no outline; lengths and coordinates are in the page of an SVG file (px), or in a
/// DXF file (mm if it states its unit).
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum DrawingError {
    #[error("the file is empty; draw one closed outline and save it as SVG or DXF")]
    Empty,
    #[error("the file is not readable as SVG: {0}; save the drawing as plain SVG")]
    NotSvg(usvg::Error),
    #[error("the file {what}; export the drawing as SVG or DXF")]
    OtherKind { what: String },
    #[error("the file is no drawing: {0}")]
    NotText(std::io::Error),
    #[error("line {line} of the DXF file: {what}")]
    NotDxf { line: usize, what: String },
    #[error(
        "an entity of the kind {kind} on the layer `{layer}` is not read; explode it in the drawing program, or switch its \
         layer off if it is no part of the outline"
    )]
    Unread { kind: String, layer: String },
    #[error(
        "the style `{name}: {value}` is not read; apply it in the drawing program, or write it as an attribute"
    )]
    Style { name: String, value: String },
    #[error(
        "there is no visible path in the file{why}; draw the outline as a path, polygon, rect, circle \
         or ellipse with a fill or a stroke, outside of <defs>, or in DXF as lines, arcs, polylines or splines in model \
         space on a layer that is on, thawed and plotted"
    )]
    NoPath { why: String },
    #[error(
        "the drawing has {found} pieces, by size {listed}; a sheet is one of them: delete the others, or write the number of one \
         behind the name of the file, as in `drawing.svg#1`, which takes it with its holes"
    )]
    Several { found: usize, listed: String },
    #[error("there is no contour {number}: the drawing has {found}, by size {listed}")]
    NoSuch { number: usize, found: usize, listed: String },
    #[error(
        "lines branch at ({x}, {y}), or lie on each other there in part: delete those that are not part of the outline"
    )]
    Branch { x: f64, y: f64 },
    #[error(
        "the path is drawn in part alone, because of the {element} `{id}`; release it in the drawing program, so that the \
         path itself is the outline"
    )]
    Cut { element: &'static str, id: String },
    #[error("the path has {found} points; simplify the outline to at most {MOST_POINTS}")]
    TooManyPoints { found: usize },
    #[error(
        "the path ends open at ({x}, {y}), {gap} from its start; close it (in SVG data with Z), or correct the mistake in the data \
         after this point"
    )]
    Open { x: f64, y: f64, gap: f64 },
    #[error(
        "the outline is {times:.0} times its own size away from the origin of its coordinates, and is read with seven digits; \
         move it to the origin"
    )]
    TooFar { times: f64 },
    #[error("the path has {found} different points; draw an outline of at least 3 points")]
    TooFewPoints { found: usize },
    #[error(
        "the path crosses or touches itself near ({x}, {y}); move its points until \
         the outline is one simple loop"
    )]
    SelfCrossing { x: f64, y: f64 },
    #[error(
        "contours cross or touch each other near ({x}, {y}); move them apart, or delete one of them"
    )]
    Crossing { x: f64, y: f64 },
    #[error("the drawing states no unit: give `height` (mm)")]
    NoUnit,
}

/// A line of a drawing, flattened to segments.
#[derive(Clone, Debug, Default)]
pub(super) struct Contour {
    pub points: Vec<[f64; 2]>,
    /// Whether its end is connected to its start.
    pub closed: bool,
    /// Whether its inside is filled: viewers close it.
    pub filled: bool,
    /// Whether it ends where more than two lines meet.
    pub branches: bool,
    /// Distance at which two points are one.
    pub rounding: f64,
}

impl Contour {
    /// Width and height of its bounding box.
    pub(super) fn size(&self) -> [f64; 2] {
        let [low, high] = polygon::bounds(self.points.iter().copied());
        [high[0] - low[0], high[1] - low[1]]
    }

    /// Whether it has an inside.
    pub(super) fn is_whole(&self) -> bool {
        self.closed || self.filled
    }

    /// It with each point once; one that returns to its start is closed.
    pub(super) fn merged(mut self) -> Self {
        let near = |p: [f64; 2], q: [f64; 2]| polygon::distance(p, q) <= self.rounding;
        let mut last = [f64::NAN; 2];
        self.points.retain(|point| {
            let kept = !near(*point, last);
            if kept {
                last = *point;
            }
            kept
        });
        while self.points.len() > 2 && near(self.points[0], last) {
            self.points.pop();
            last = self.points[self.points.len() - 1];
            self.closed = true;
        }
        self
    }

    /// Checks that it is an outline; returns the length of the line that closes it.
    pub(super) fn check(&self) -> Result<f64, DrawingError> {
        let found = self.points.len();
        let last = self.points[found - 1];
        let gap = match self.closed {
            true => 0.0,
            false => polygon::distance(self.points[0], last),
        };
        let [x, y] = last.map(rounded);
        if self.branches && !self.closed {
            return Err(DrawingError::Branch { x, y });
        }
        if found < 3 {
            return Err(DrawingError::TooFewPoints { found });
        }
        if !self.is_whole() {
            return Err(DrawingError::Open { x, y, gap: rounded(gap) });
        }
        let [width, height] = self.size();
        let times = self.rounding / WELD / width.max(height);
        if times > TOO_FAR {
            return Err(DrawingError::TooFar { times });
        }
        if found > MOST_POINTS {
            return Err(DrawingError::TooManyPoints { found });
        }
        let [x0, y0] = self.points[0];
        let near_zero: Vec<_> = self.points.iter().map(|[x, y]| [x - x0, y - y0]).collect();
        match polygon::self_crossing(&near_zero) {
            Some([x, y]) => {
                Err(DrawingError::SelfCrossing { x: rounded(x + x0), y: rounded(y + y0) })
            }
            None => Ok(gap),
        }
    }
}

/// Number of segments of a flattened curve.
const SEGMENTS: usize = 32;

/// Appends a Bezier curve that starts at the last point, by de Casteljau's algorithm.
pub(super) fn flatten(points: &mut Vec<[f64; 2]>, controls: &[[f64; 2]]) {
    let start = points.last().copied();
    let controls: Vec<[f64; 2]> = start.iter().chain(controls).copied().collect();
    for i in 1..=SEGMENTS {
        let t = i as f64 / SEGMENTS as f64;
        let mut level = controls.clone();
        while level.len() > 1 {
            level = (level.windows(2))
                .map(|pair| [0, 1].map(|c| (1.0 - t) * pair[0][c] + t * pair[1][c]))
                .collect();
        }
        points.push(level[0]);
    }
}

/// A coordinate of a message.
pub(super) fn rounded(x: f64) -> f64 {
    (1e5 * x).round() / 1e5
}
