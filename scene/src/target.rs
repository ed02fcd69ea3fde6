//! The target outline T of (16): a closed curve, sampled densely at equal arc lengths.

use crate::{
    drawing::{drawn_outline, outline_points},
    rounding::rounded,
};
use design::geometry::{
    plane::{complex, point},
    polygon,
    region::Region,
    similarity::Similarity,
};
use faer::c64;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::{
    f64::consts::TAU,
    path::{Path, PathBuf},
};
use support::{Fault, Point, at, ensure, fault, key_limits, regular_file};

/// A target as written in a scene; lengths in mm, in the coordinates of the flat sheet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum TargetShape {
    /// A circle.
    Circle {
        /// Centre (mm).
        centre: Point,
        /// Radius (mm).
        #[schemars(range(min = 1e-3))]
        radius: f64,
    },
    /// A rectangle, rotated about its centre.
    Rectangle {
        /// Centre (mm).
        centre: Point,
        /// Side lengths [along x, along y] before the rotation (mm).
        #[schemars(inner(range(min = 1e-3)))]
        size: [f64; 2],
        /// Rotation about the centre, counter-clockwise (deg).
        rotation_deg: f64,
    },
    /// A polygon; the last vertex is connected to the first.
    Polygon {
        /// Vertices in order around the outline (mm), at least three.
        vertices: Vec<Point>,
    },
    /// A smooth closed curve through points, in order around the outline: between two of them the
    /// cubic whose tangent at each is half the vector from the point before it to that after it
    /// (Catmull and Rom 1974).
    Curve {
        /// The points (mm), at least three.
        points: Vec<Point>,
    },
    /// A polygon in a file with one point a line, in order or in blocks whose ends meet: x and y (mm,
    /// or the unit behind their names), with commas, semicolons, tabs or blanks between them; `#`
    /// starts a comment.
    Csv {
        /// Path of the file, relative to the folder of the scene.
        file: PathBuf,
    },
    /// The outline in a drawing (SVG, SVGZ or DXF): one closed contour and the holes in it, none of
    /// which cross.
    Svg {
        /// Path of the file, relative to the folder of the scene; of several pieces behind `#` the
        /// number, the largest first: `parts.dxf#2`.
        file: PathBuf,
        /// Centre of the bounding box of the outline (mm).
        centre: Point,
        /// Height of the bounding box (mm); the width follows from the drawing. A DXF file with a
        /// unit has its own.
        #[schemars(range(min = 1e-3))]
        height: Option<f64>,
        /// Rotation about the centre, counter-clockwise (deg).
        #[serde(default)]
        rotation_deg: f64,
    },
}

impl TargetShape {
    /// The file that the target is read from, if there is one, and the name of its copy in the
    /// folder of a run.
    pub(crate) fn file_mut(&mut self) -> Option<(&'static str, &mut PathBuf)> {
        match self {
            Self::Csv { file } => Some(("target.csv", file)),
            Self::Svg { file, .. } => {
                let text = file.to_string_lossy().to_lowercase();
                let is_dxf = text.contains(".dxf");
                let name = if is_dxf { "target.dxf" } else { "target.svg" };
                Some((name, file))
            }
            Self::Circle { .. }
            | Self::Rectangle { .. }
            | Self::Polygon { .. }
            | Self::Curve { .. } => None,
        }
    }
}

/// Number of points on the target of a scene.
pub const TARGET_POINTS: usize = 1000;
/// Points along a drawn outline from which its area is computed.
const DRAWING_POINTS: usize = 2000;

/// The sampled target.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Target {
    /// The samples, evenly spaced along the outline (mm).
    pub points: Vec<Point>,
    /// The corners of its holes (mm).
    pub holes: Vec<Vec<Point>>,
    /// Length of the outline itself (mm).
    pub length: f64,
    /// A point at which the outline crosses or touches itself, so that its inside is not defined
    /// (mm).
    pub crossing: Option<Point>,
    /// What the reader of its drawing added or could not read.
    pub notes: Vec<String>,
}

impl Target {
    /// Samples a shape at `count` points; file names are relative to `folder`.
    pub fn sample(shape: &TargetShape, folder: &Path, count: usize) -> Result<Self, Fault> {
        key_limits::check::<TargetShape>(shape)?;
        match shape {
            TargetShape::Circle { centre, radius } => {
                let points = (0..count)
                    .map(|i| {
                        let (sin, cos) = (TAU * i as f64 / count as f64).sin_cos();
                        [centre[0] + radius * cos, centre[1] + radius * sin]
                    })
                    .collect();
                Ok(Self { points, length: TAU * radius, ..Self::default() })
            }
            TargetShape::Rectangle { centre, size, rotation_deg } => {
                let (sin, cos) = rotation_deg.to_radians().sin_cos();
                let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(a, b)| {
                    let [x, y] = [a * size[0], b * size[1]];
                    [centre[0] + cos * x - sin * y, centre[1] + sin * x + cos * y]
                });
                along_polygon(&corners, count)
            }
            TargetShape::Polygon { vertices } => along_polygon(vertices, count),
            TargetShape::Curve { points } => along_polygon(&curve(points), count),
            TargetShape::Csv { file } => {
                along_polygon(&outline_points::read(&folder.join(file))?, count)
            }
            TargetShape::Svg { file, centre, height, rotation_deg } => {
                let (path, number) = drawn_outline::numbered(&folder.join(file));
                let named = &path.display();
                let bytes = regular_file::read(&path);
                let bytes = bytes.map_err(at(format!("cannot read the target outline {named}")))?;
                Self::drawn(&bytes, number, *centre, *height, *rotation_deg, count)
                    .map_err(at(named))
            }
        }
    }

    /// Samples the outline with a number in the bytes of a drawing.
    fn drawn(
        bytes: &[u8],
        number: Option<usize>,
        centre: Point,
        height: Option<f64>,
        rotation_deg: f64,
        count: usize,
    ) -> Result<Self, Fault> {
        let drawn = drawn_outline::of_file(bytes, number)?;
        let [_, own] = polygon::size(polygon::bounds(drawn.vertices.iter().copied()));
        let height = height.or(drawn.has_unit.then_some(own));
        let height =
            height.ok_or_else(|| fault!("the drawing states no unit: give `height` (mm)"))?;
        let place = place(&drawn.vertices, centre, height, rotation_deg)?;
        let placed = |vertices: &Vec<Point>| -> Vec<Point> {
            vertices.iter().map(|vertex| point(place.of(complex(*vertex)))).collect()
        };
        let holes = drawn.holes.iter().map(placed).collect();
        let gap = drawn.gap * height / own;
        let closed = (gap > 0.0).then(|| {
            format!("it is open: a straight line of {gap:.2} mm was added, as viewers fill it")
        });
        let notes = closed.into_iter().chain(drawn.warnings).collect();
        Ok(Self { notes, holes, ..along_polygon(&placed(&drawn.vertices), count)? })
    }

    /// Centre of the bounding box and height (mm) at which the outline with a number in the bytes of
    /// a drawing (SVG or DXF), with its holes, has the given area (mm^2) and the mean of its points
    /// at `centre` (mm).
    pub fn place_drawing(
        bytes: &[u8],
        number: Option<usize>,
        centre: Point,
        area: f64,
    ) -> Result<(Point, f64), Fault> {
        let outline = Self::drawn(bytes, number, [0.0; 2], Some(1.0), 0.0, DRAWING_POINTS)?;
        let height = rounded((area / polygon::area(&outline.points).abs()).sqrt());
        let offset = outline.mean();
        Ok(([0, 1].map(|i| rounded(centre[i] - height * offset[i])), height))
    }

    /// BLAKE3 hash of the samples and the holes.
    pub fn hash(&self) -> String {
        let points = self.holes.iter().chain([&self.points]).flatten().flatten();
        let bytes: Vec<u8> = points.flat_map(|x| x.to_le_bytes()).collect();
        blake3::hash(&bytes).to_hex().to_string()
    }

    /// Mean of the samples: the centre of the outline (mm).
    pub fn mean(&self) -> Point {
        polygon::mean(&self.points)
    }

    /// Extent of the samples along x (mm).
    pub fn width(&self) -> f64 {
        polygon::size(polygon::bounds(self.points.iter().copied()))[0]
    }

    /// Distance of a point to the curve through the samples (mm).
    pub fn distance(&self, point: Point) -> f64 {
        polygon::distance_to_outline(point, &self.points)
    }

    /// What the curve through the samples encloses, without the holes.
    pub fn region(&self) -> Region {
        Region::even_odd(self.holes.iter().chain([&self.points]).cloned().collect())
    }

    /// Area inside the curve through the samples, without the holes (mm^2).
    pub fn area(&self) -> f64 {
        let area = |points: &Vec<Point>| polygon::area(points).abs();
        area(&self.points) - self.holes.iter().map(area).sum::<f64>()
    }
}

const NO_AREA: &str = "the target outline encloses no area: give at least three corners in order";

/// `count` points at equal arc lengths along a closed polygon.
fn along_polygon(vertices: &[Point], count: usize) -> Result<Target, Fault> {
    let edges = || polygon::edges(vertices);
    let lengths: Vec<f64> = edges().map(|(p, q)| polygon::distance(p, q)).collect();
    let length: f64 = lengths.iter().sum();
    ensure!(polygon::area(vertices).abs() > 1e-9 * length * length, "{NO_AREA}");
    let mut points = Vec::with_capacity(count);
    let mut start = 0.0;
    for ((p, q), edge) in edges().zip(lengths) {
        while points.len() < count {
            let along = length * points.len() as f64 / count as f64 - start;
            if along >= edge {
                break;
            }
            let f = along / edge;
            points.push([p[0] + f * (q[0] - p[0]), p[1] + f * (q[1] - p[1])]);
        }
        start += edge;
    }
    // A file may repeat a vertex, such as the first at its end: an edge without length crosses
    // nothing.
    let distinct: Vec<Point> = (edges().filter(|(p, q)| p != q).map(|(p, _)| p)).collect();
    let crossing = polygon::self_crossing(&distinct);
    Ok(Target { points, length, crossing, ..Target::default() })
}

/// Number of chords of a curve between two of its points.
const CHORDS: usize = 64;

/// Vertices on the closed curve through points.
fn curve(points: &[Point]) -> Vec<Point> {
    let n = points.len();
    if n < 3 {
        return points.to_vec();
    }
    let tangent = |i: usize, c: usize| 0.5 * (points[(i + 1) % n][c] - points[(i + n - 1) % n][c]);
    let at = |i: usize, t: f64| {
        let next = (i + 1) % n;
        let from = (1.0 - t) * (1.0 - t);
        let to = t * t;
        [0, 1].map(|c| {
            from * ((1.0 + 2.0 * t) * points[i][c] + t * tangent(i, c))
                + to * ((3.0 - 2.0 * t) * points[next][c] - (1.0 - t) * tangent(next, c))
        })
    };
    let chords = (0..n).flat_map(|i| (0..CHORDS).map(move |k| (i, k as f64 / CHORDS as f64)));
    chords.map(|(i, t)| at(i, t)).collect()
}

/// The motion of vertices that gives their bounding box a height and a centre (mm), and turns them
/// about it.
fn place(
    vertices: &[Point],
    centre: Point,
    height: f64,
    rotation_deg: f64,
) -> Result<Similarity, Fault> {
    let [[left, low], [right, high]] = polygon::bounds(vertices.iter().copied());
    ensure!(high > low && !vertices.is_empty(), "{NO_AREA}");
    let turn = c64::cis(rotation_deg.to_radians()) * (height / (high - low));
    let middle = complex([0.5 * (left + right), 0.5 * (low + high)]);
    Ok(Similarity { turn, shift: complex(centre) - turn * middle })
}

#[cfg(test)]
mod tests;
