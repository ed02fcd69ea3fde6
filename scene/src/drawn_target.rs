//! A drawing as the target of a sheet.

use crate::{rounding::rounded, target::TargetShape};
use design::geometry::{
    plane::{complex, point},
    similarity::Similarity,
};
use support::Point;

impl TargetShape {
    /// The shape after a motion and a change of size. `points` are samples of it, which stand for a
    /// polygon that is in a file.
    pub fn placed(self, place: &Similarity, points: &[Point]) -> Self {
        let at = |p: Point| point(place.of(complex(p))).map(rounded);
        let scaled = |length: f64| rounded(length * place.scale());
        let turned = |deg: f64| rounded(deg + place.rotation().to_degrees());
        let all = |points: &[Point]| points.iter().copied().map(at).collect();
        match self {
            Self::Circle { centre, radius } => {
                Self::Circle { centre: at(centre), radius: scaled(radius) }
            }
            Self::Rectangle { centre, size, rotation_deg } => Self::Rectangle {
                centre: at(centre),
                size: size.map(scaled),
                rotation_deg: turned(rotation_deg),
            },
            Self::Polygon { vertices } => Self::Polygon { vertices: all(&vertices) },
            Self::Curve { points } => Self::Curve { points: all(&points) },
            Self::Csv { .. } => Self::Polygon { vertices: all(points) },
            Self::Svg { file, centre, height, rotation_deg } => Self::Svg {
                file,
                centre: at(centre),
                height: height.map(scaled),
                rotation_deg: turned(rotation_deg),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::target::Target;
    use faer::c64;
    use std::path::Path;

    #[test]
    fn a_shape_is_placed_as_its_points_are() {
        let place = Similarity { turn: c64::cis(0.4) * 1.7, shift: c64::new(30.0, -12.0) };
        let corners = vec![[0.0, 0.0], [9.0, 1.0], [7.0, 6.0], [1.0, 5.0]];
        for shape in [
            TargetShape::Circle { centre: [3.0, 4.0], radius: 2.0 },
            TargetShape::Rectangle { centre: [3.0, 4.0], size: [5.0, 2.0], rotation_deg: 20.0 },
            TargetShape::Polygon { vertices: corners.clone() },
            TargetShape::Curve { points: corners },
        ] {
            let points = |shape: &TargetShape| Target::sample(shape, Path::new(""), 400).unwrap();
            let before = points(&shape).points;
            let moved = points(&shape.placed(&place, &before));
            let area = Target::area(&moved);
            for point_before in &before {
                let expected = point(place.of(complex(*point_before)));
                assert!(moved.distance(expected) < 1e-3 * area.sqrt());
            }
        }
    }
}
