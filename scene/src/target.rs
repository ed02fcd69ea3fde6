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
mod tests {
    use super::*;
    use testkit::derivatives::assert_close;

    fn sample(shape: TargetShape, count: usize) -> Result<Target, Fault> {
        Target::sample(&shape, Path::new("."), count)
    }

    /// Area of the polygon through the samples.
    fn area(points: &[[f64; 2]]) -> f64 {
        let pairs = (0..points.len()).map(|i| (points[i], points[(i + 1) % points.len()]));
        pairs.map(|(p, q)| (p[0] * q[1] - p[1] * q[0]) / 2.0).sum()
    }

    #[test]
    fn a_circle_has_its_length_and_its_area() {
        let (radius, n) = (760.0, 500);
        let centre = [1.0, 2.0];
        let circle = sample(TargetShape::Circle { centre, radius }, n).unwrap();
        assert_eq!(circle.points.len(), n);
        assert_close(circle.length, TAU * radius, 1e-9);
        let inscribed = 0.5 * n as f64 * radius * radius * (TAU / n as f64).sin();
        assert_close(area(&circle.points) / inscribed, 1.0, 1e-12);
    }

    #[test]
    fn a_rotated_rectangle_is_sampled_evenly_by_arc_length() {
        let shape = TargetShape::Rectangle {
            centre: [100.0, -50.0],
            size: [300.0, 200.0],
            rotation_deg: -15.4,
        };
        let rectangle = sample(shape, 100).unwrap();
        assert_close(rectangle.length, 1000.0, 1e-9);
        let (sin, cos) = 15.4_f64.to_radians().sin_cos();
        assert_close(rectangle.width(), 300.0 * cos + 200.0 * sin, 1e-9);
        let p = &rectangle.points;
        assert_eq!(p.len(), 100);
        // Corners are multiples of the spacing.
        assert_close(area(p), 60e3, 1e-6);
        for i in 0..100 {
            let (a, b) = (p[i], p[(i + 1) % 100]);
            assert_close(polygon::distance(a, b), 10.0, 1e-9);
        }
        let slope = (p[1][1] - p[0][1]).atan2(p[1][0] - p[0][0]).to_degrees();
        // The long side is rotated clockwise.
        assert_close(slope, -15.4, 1e-9);
    }

    #[test]
    fn a_curve_passes_through_its_points_and_is_nearly_the_circle_of_many() {
        let circle = |n: usize| -> Vec<[f64; 2]> {
            let angle = |i: usize| TAU * i as f64 / n as f64;
            let point = |i: usize| [50.0 * angle(i).cos(), 50.0 * angle(i).sin()];
            (0..n).map(point).collect()
        };
        let error = |n: usize| {
            let points = circle(n);
            let vertices = curve(&points);
            for (i, point) in points.iter().enumerate() {
                assert!(polygon::distance(vertices[i * CHORDS], *point) < 1e-12);
            }
            let off = |[x, y]: &[f64; 2]| (x.hypot(*y) / 50.0 - 1.0).abs();
            vertices.iter().map(off).fold(0.0, f64::max)
        };
        // The tangents are wrong by a factor sin(x)/x, x = TAU/n: half way the radius by the order
        // of x^2 at least.
        assert!(error(8) < 0.02 && error(16) < error(8) / 8.0);
        let points = circle(12);
        let target = sample(TargetShape::Curve { points }, 600).unwrap();
        assert_close(target.length / (TAU * 50.0), 1.0, 1e-2);
        let points = vec![[0.0; 2]; 2];
        assert!(sample(TargetShape::Curve { points }, 10).is_err());
    }

    #[test]
    fn a_polygon_and_its_file_are_the_same_target() {
        let folder = tempfile::tempdir().unwrap();
        let from_file = |text: &str| {
            std::fs::write(folder.path().join("triangle.csv"), text).unwrap();
            let file = "triangle.csv".into();
            Target::sample(&TargetShape::Csv { file }, folder.path(), 24)
        };
        let triangle = from_file("# a 3-4-5 triangle\n0,0\n40, 0 # mm\n\n0,30\n").unwrap();
        let vertices = vec![[0.0, 0.0], [40.0, 0.0], [0.0, 30.0]];
        let polygon = sample(TargetShape::Polygon { vertices }, 24).unwrap();
        assert_eq!(triangle, polygon);
        assert_close(triangle.length, 120.0, 1e-12);
        assert_close(area(&triangle.points), 600.0, 1e-9);
        let error = from_file("0,0\n1;2\n3,4\n").unwrap_err().to_string();
        assert!(error.contains("triangle.csv:2: `1;2`"), "{error}");
    }

    #[test]
    fn the_supplied_drawings_keep_their_outlines() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/targets");
        // Length and area for the height 1; usvg rounds coordinates to 24 bits, 6e-8 of their size.
        for (name, length, area) in [
            ("bell.svg", 3.206797259038, 0.611059318901),
            ("leaf.svg", 2.534298840394, 0.471824228324),
            ("shield.svg", 2.831988536962, 0.537239778161),
            ("vase.svg", 2.922806221912, 0.525268029739),
        ] {
            let shape = TargetShape::Svg {
                file: name.into(),
                centre: [0.0, 0.0],
                height: Some(1.0),
                rotation_deg: 0.0,
            };
            let target = Target::sample(&shape, &folder, 2000).unwrap();
            assert_close(target.length, length, 1e-6);
            assert_close(target.area(), area, 1e-6);
        }
    }

    #[test]
    fn a_drawing_that_crosses_itself_is_refused_by_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let star = "<svg><path d='M 0 -80 L 47 65 L -76 -25 L 76 -25 L -47 65 Z'/></svg>";
        std::fs::write(folder.path().join("star.svg"), star).unwrap();
        let shape = TargetShape::Svg {
            file: "star.svg".into(),
            centre: [0.0, 0.0],
            height: Some(100.0),
            rotation_deg: 0.0,
        };
        let error = Target::sample(&shape, folder.path(), 100).unwrap_err();
        let error = error.to_string();
        assert!(error.contains("star.svg: "), "{error}");
        assert!(error.contains("crosses or touches itself"), "{error}");
    }

    #[test]
    fn the_crossing_of_an_outline_is_found() {
        let crossing = |vertices: &[[f64; 2]]| {
            let vertices = vertices.to_vec();
            let target = sample(TargetShape::Polygon { vertices }, 100);
            target.unwrap().crossing
        };
        let square = [[0.0, 0.0], [40.0, 0.0], [40.0, 40.0], [0.0, 40.0]];
        assert_eq!(crossing(&square), None);
        // The first vertex repeated at the end.
        let closed = [&square[..], &square[..1]].concat();
        assert_eq!(crossing(&closed), None);
        // The edges from (40, 0) to (0, 40) and from (30, 40) to (0, 0) cross where x + y = 40 and
        // y = 4/3 x.
        let bow = [[0.0, 0.0], [40.0, 0.0], [0.0, 40.0], [30.0, 40.0]];
        let [x, y] = crossing(&bow).unwrap();
        assert!((x - 120.0 / 7.0).abs() < 1e-9 && (y - 160.0 / 7.0).abs() < 1e-9);
    }

    #[test]
    fn shapes_without_an_outline_are_refused() {
        let line = vec![[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]];
        let polygon = |vertices| TargetShape::Polygon { vertices };
        let centre = [0.0, 0.0];
        let circle = |radius| TargetShape::Circle { centre, radius };
        for (shape, expected) in [
            (polygon(line), "no area"),
            (polygon(vec![]), "no area"),
            (circle(-1.0), "circle.radius = -1"),
            (circle(f64::NAN), "circle.radius"),
        ] {
            let error = sample(shape, 10).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }
}
