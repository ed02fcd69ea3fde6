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
